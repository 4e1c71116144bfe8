#include "tools/export/hdf5/h5_file.hpp"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>
#if __has_include(<H5FDdevelop.h>)
#include <H5FDdevelop.h>
#endif

#include "store/base/error.hpp"

// HDF5 of Debian 13 can read from S3. Every program would need libcurl and libcrypto for it, unless what HDF5 begins it with is here already.
extern "C" hid_t H5FD_ros3_init() { return -1; }

namespace teracell::exports {

// A file that HDF5 has open. HDF5 takes the address of `base` for that of the file.
struct H5Driver {
  H5FD_t base{};
  H5File* file = nullptr;
  haddr_t end_of_space = 0;  // of what HDF5 has given out, written or not

  static H5Driver& of(const H5FD_t* file) { return *reinterpret_cast<H5Driver*>(const_cast<H5FD_t*>(file)); }

  static H5FD_t* open(const char*, unsigned, hid_t access, haddr_t) {
    auto* driver = new H5Driver;
    driver->file = *static_cast<H5File* const*>(H5Pget_driver_info(access));
    return &driver->base;
  }
  static herr_t close(H5FD_t* file) {
    delete &of(file);
    return 0;
  }
  static herr_t query(const H5FD_t*, unsigned long* flags) {
    *flags = H5FD_FEAT_AGGREGATE_METADATA | H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA;
    return 0;
  }
  static haddr_t get_eoa(const H5FD_t* file, H5FD_mem_t) { return of(file).end_of_space; }
  static herr_t set_eoa(H5FD_t* file, H5FD_mem_t, haddr_t end) {
    of(file).end_of_space = end;
    return 0;
  }
  static haddr_t get_eof(const H5FD_t* file, H5FD_mem_t) { return of(file).file->file_.size(); }
  static herr_t read(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t from, size_t size, void* bytes) {
    H5File& f = *of(file).file;
    std::memset(bytes, 0, size);  // beyond the end of the file
    return guarded(f, [&] {
      if (from < f.file_.size()) f.file_.read_kept(from, {static_cast<uint8_t*>(bytes), std::min<uint64_t>(size, f.file_.size() - from)});
    });
  }
  static herr_t write(H5FD_t* file, H5FD_mem_t, hid_t, haddr_t to, size_t size, const void* bytes) {
    H5File& f = *of(file).file;
    return f.failure_ ? 0 : guarded(f, [&] { f.file_.write_at(to, {static_cast<const uint8_t*>(bytes), size}); });
  }
  // Space that was given out last need not have been written.
  static herr_t truncate(H5FD_t* file, hid_t, hbool_t) {
    H5File& f = *of(file).file;
    const haddr_t end = of(file).end_of_space;
    return f.failure_ || end <= f.file_.size() ? 0 : guarded(f, [&] { f.file_.write_at(end - 1, Bytes{0}); });
  }

  template <class Work>
  static herr_t guarded(H5File& f, const Work& work) {
    try {
      work();
    } catch (...) {
      f.failure_ = std::current_exception();
    }
    return 0;
  }

  static const H5FD_class_t kClass;
};

const H5FD_class_t H5Driver::kClass = {
#ifdef H5FD_CLASS_VERSION  // HDF5 1.14
    .version = H5FD_CLASS_VERSION,
    .value = H5FD_class_value_t{400},  // 256 to 511 are for drivers that are not registered with its makers
#endif
    .name = "teracell",
    .maxaddr = haddr_t{1} << 62,
    .fc_degree = H5F_CLOSE_STRONG,  // objects that an exception left open are closed with the file
    .fapl_size = sizeof(H5File*),
    .open = H5Driver::open,
    .close = H5Driver::close,
    .query = H5Driver::query,
    .get_eoa = H5Driver::get_eoa,
    .set_eoa = H5Driver::set_eoa,
    .get_eof = H5Driver::get_eof,
    .read = H5Driver::read,
    .write = H5Driver::write,
    .truncate = H5Driver::truncate,
    .fl_map = H5FD_FLMAP_DICHOTOMY,
};

namespace {

H5Handle text_type() {
  H5Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, H5T_VARIABLE);
  H5Tset_cset(type, H5T_CSET_UTF8);
  return type;
}

}  // namespace

H5File::H5File(const std::filesystem::path& target) : name_(target.string()), file_(target, 0, true) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // it prints nothing
  static const hid_t driver = H5FDregister(&H5Driver::kClass);
  checked(driver, "take its driver of files");
  const H5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5File* const self = this;
  checked(H5Pset_driver(access, driver, &self), "choose the driver");
  id_ = checked(H5Fcreate(name_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), "create the file");
}

H5File::~H5File() {
  if (id_ < 0) return;
  if (!failure_) failure_ = std::make_exception_ptr(IoError(name_ + ": abandoned"));  // nothing of what is left has to be written
  H5Fclose(id_);
}

void H5File::fail(const char* what) const {
  if (failure_) std::rethrow_exception(failure_);
  std::string reason;  // the innermost one
  H5Ewalk2(
      H5E_DEFAULT, H5E_WALK_UPWARD,
      [](unsigned n, const H5E_error2_t* error, void* out) -> herr_t {
        if (n == 0 && error->desc != nullptr) *static_cast<std::string*>(out) = error->desc;
        return 0;
      },
      &reason);
  throw IoError(fmt::format("{}: HDF5 can't {}: {}", name_, what, reason.empty() ? "it gives no reason" : reason));
}

H5Handle H5File::group(const char* name) {
  return {checked(H5Gcreate2(id_, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), "create a group"), H5Gclose};
}

void H5File::put_attribute(hid_t object, const char* name, hid_t type, size_t count, const void* values) {
  const hsize_t n = count;
  const H5Handle space(checked(count == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &n, nullptr), "describe an attribute"), H5Sclose);
  const H5Handle attribute(checked(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), "create an attribute"), H5Aclose);
  checked(H5Awrite(attribute, type, values), "write an attribute");
}

void H5File::attribute(hid_t object, const char* name, const std::string& text) {
  const char* const value = text.c_str();
  put_attribute(object, name, text_type(), 0, &value);
}

H5Handle H5File::without_times() const {
  H5Handle how(checked(H5Pcreate(H5P_DATASET_CREATE), "describe a dataset"), H5Pclose);
  checked(H5Pset_obj_track_times(how, 0), "leave out times");
  return how;
}

void H5File::put_dataset(hid_t place, const char* name, hid_t type, size_t count, const void* values) {
  const hsize_t n = count;
  const H5Handle space(checked(H5Screate_simple(1, &n, nullptr), "describe a dataset"), H5Sclose);
  const H5Handle dataset(checked(H5Dcreate2(place, name, type, space, H5P_DEFAULT, without_times(), H5P_DEFAULT), "create a dataset"), H5Dclose);
  checked(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values), "write a dataset");
}

void H5File::dataset(hid_t place, const char* name, const std::vector<const char*>& texts) {
  put_dataset(place, name, text_type(), texts.size(), texts.data());
}

void H5File::doubles(hid_t place, const char* name, int64_t count, const std::function<double(int64_t)>& value) {
  constexpr int64_t kPiece = 1 << 16;
  const hsize_t n = static_cast<hsize_t>(count);
  const H5Handle space(checked(H5Screate_simple(1, &n, nullptr), "describe a dataset"), H5Sclose);
  const H5Handle dataset(checked(H5Dcreate2(place, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, without_times(), H5P_DEFAULT), "create a dataset"),
                         H5Dclose);
  std::vector<double> piece;
  for (int64_t at = 0; at < count; at += kPiece) {
    piece.clear();
    for (int64_t i = at; i < std::min(count, at + kPiece); ++i) piece.push_back(value(i));
    const hsize_t from = static_cast<hsize_t>(at), size = piece.size();
    const H5Handle part(checked(H5Screate_simple(1, &size, nullptr), "describe a dataset"), H5Sclose);
    checked(H5Sselect_hyperslab(space, H5S_SELECT_SET, &from, nullptr, &size, nullptr), "choose a part of a dataset");
    checked(H5Dwrite(dataset, H5T_IEEE_F64LE, part, space, H5P_DEFAULT, piece.data()), "write a dataset");
  }
}

void H5File::finish() {
  const herr_t closed = H5Fclose(std::exchange(id_, -1));
  checked(closed, "end the file");
  file_.sync();
}

void H5File::commit() {
  if (id_ >= 0) finish();
  file_.commit();
}

}  // namespace teracell::exports
