// An HDF5 file that appears by way of OutputFile, and the errors of its library as ours.
//
// HDF5 does not outlive a write that fails: it tries again when it closes, and ends in a state in which it prints, crashes or keeps the
// file open. So it never hears of one. What it writes passes through a driver of ours, which keeps the first error to itself and drops what
// comes after it; checked() and finish() throw the error.
#pragma once
#include <exception>
#include <functional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <hdf5.h>

#include "store/base/output_file.hpp"

namespace teracell::exports {

// An identifier that HDF5 gave out, which is given back.
class H5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  H5Handle(hid_t id, Close close) : id_(id), close_(close) {}
  H5Handle(H5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  ~H5Handle() {
    if (id_ >= 0) close_(id_);
  }
  operator hid_t() const { return id_; }

 private:
  hid_t id_;
  Close close_;
};

// The type of a number, in the file and in memory.
template <class T>
hid_t h5_type() {
  if constexpr (std::is_same_v<T, uint8_t>) return H5T_STD_U8LE;
  if constexpr (std::is_same_v<T, uint16_t>) return H5T_STD_U16LE;
  if constexpr (std::is_same_v<T, uint32_t>) return H5T_STD_U32LE;
  if constexpr (std::is_same_v<T, int16_t>) return H5T_STD_I16LE;
  if constexpr (std::is_same_v<T, int32_t>) return H5T_STD_I32LE;
  if constexpr (std::is_same_v<T, int64_t>) return H5T_STD_I64LE;
  if constexpr (std::is_same_v<T, float>) return H5T_IEEE_F32LE;
  if constexpr (std::is_same_v<T, double>) return H5T_IEEE_F64LE;
}

class H5File {
 public:
  explicit H5File(const std::filesystem::path& target);
  ~H5File();
  H5File(const H5File&) = delete;

  hid_t id() const { return id_; }
  // What a function of HDF5 has returned, unless it failed or a byte could not be written before.
  template <class T>
  T checked(T result, const char* what) const {
    if (failure_ || result < 0) fail(what);
    return result;
  }

  H5Handle group(const char* name);
  // How datasets are created: without the time, so that the same cells give the same bytes.
  H5Handle without_times() const;
  void attribute(hid_t object, const char* name, const std::string& text);
  template <class T>
  void attribute(hid_t object, const char* name, std::span<const T> values) {
    put_attribute(object, name, h5_type<T>(), values.size(), values.data());
  }
  template <class T>
  void attribute(hid_t object, const char* name, const T& value) {  // a scalar
    put_attribute(object, name, h5_type<T>(), 0, &value);
  }
  // Rows of numbers or texts.
  template <class T>
  void dataset(hid_t place, const char* name, std::span<const T> values) {
    put_dataset(place, name, h5_type<T>(), values.size(), values.data());
  }
  void dataset(hid_t place, const char* name, const std::vector<const char*>& texts);
  // Writes `count` doubles that are asked for one by one.
  void doubles(hid_t place, const char* name, int64_t count, const std::function<double(int64_t)>& value);

  // When it returns, the file is complete and on disk, under the temporary name. Nothing may be added any more.
  void finish();
  void commit();  // finishes it, if that was not done

 private:
  [[noreturn]] void fail(const char* what) const;
  void put_attribute(hid_t object, const char* name, hid_t type, size_t count, const void* values);
  void put_dataset(hid_t place, const char* name, hid_t type, size_t count, const void* values);

  const std::string name_;
  OutputFile file_;
  std::exception_ptr failure_;
  hid_t id_ = -1;
  friend struct H5Driver;
};

}  // namespace teracell::exports
