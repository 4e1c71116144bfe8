// The bytes of a surface file, plain or compressed by gzip. They are read once, from front to back, through a window, and
// hashed as they are on disk. Files are read block by block with read(2) and not mapped: mapped pages count as memory of this
// process, and a mesh may be larger than the machine's memory. A gzip file may have several members, and zero padding after
// the last one.
//
// Not to be shared by threads. Views into the window are valid until the next call that reads.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "store/base/descriptor.hpp"

struct XXH3_state_s;
struct z_stream_s;

namespace teracell::mesher {

class Input {
 public:
  // Throws IoError when the file can't be opened or read.
  explicit Input(const std::filesystem::path& path);
  // Reads bytes in memory, which must outlive the Input. `name` stands for the file in messages.
  Input(std::string name, std::string_view bytes);
  ~Input();
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  const std::string& name() const { return name_; }
  bool compressed() const { return inflate_ != nullptr; }
  // Bytes of the contents; unknown when they are compressed or come through a pipe.
  std::optional<uint64_t> size() const { return size_; }
  bool regular() const { return regular_; }  // the file can be read again: it is no pipe and no device
  // Bytes of the contents taken so far.
  uint64_t offset() const { return offset_ + begin_; }

  // The bytes that come next, without taking them: at least `want`, fewer only at the end. REQUIRES: want <= kWindow.
  static constexpr size_t kWindow = size_t{1} << 18;
  std::string_view window(size_t want) {
    if (end_ - begin_ < want) fill(want);
    return {buffer_.data() + begin_, end_ - begin_};
  }
  // Takes the bytes that come next into `out`, fewer only at the end. Sets `got` to how many there were, also where it throws.
  void take(std::span<char> out, size_t& got);
  // REQUIRES: n <= window(0).size().
  void consume(size_t n) { begin_ += n; }
  // The same for `n` bytes that make up `lines` whole lines.
  void consume_lines(size_t n, uint64_t lines) {
    consume(n);
    line_ += lines;
  }

  // A whole line is held in memory. Lines may be this long, which is enough for polygons of a million vertices; without a limit
  // a file of zeros would fill the memory.
  static constexpr size_t kLongestLine = size_t{1} << 24;
  // Takes the next line, without its "\n" or "\r\n", which the last line need not have. False at the end of the contents.
  bool next_line(std::string_view& line);
  // '\r' for texts with the line ends of classic Mac OS.
  void set_newline(char c) { newline_ = c; }

  // The number of the last line taken; the first line is 1.
  uint64_t line() const { return line_; }
  // The current position for messages: "hull.stl: line 7" (the last line taken), "hull.stl: byte 84".
  std::string at_line() const;
  std::string at_byte(uint64_t offset) const;
  std::string at_byte() const { return at_byte(offset()); }

  // A plain file as the system knows it, to be read at any place; none for what is compressed, comes through a pipe or lies in memory.
  Descriptor plain_file() const;
  // The bytes in memory, if they aren't compressed.
  std::optional<std::string_view> plain_memory() const;

  // Of the file on disk; complete once window(1) is empty.
  uint64_t bytes_on_disk() const { return disk_bytes_; }
  std::string hash() const;  // XXH3-128 as 32 hex digits, as xxhsum prints it

 private:
  struct Release {
    void operator()(XXH3_state_s*) const;
    void operator()(z_stream_s*) const;
  };
  void begin();
  void fill(size_t want);
  size_t read_disk(char* to, size_t room);
  size_t read_inflated(char* to, size_t room);
  bool more_compressed();
  [[noreturn]] void damaged(const char* what) const;

  std::string name_;
  int descriptor_ = -1;      // of the file, or
  std::string_view memory_;  // the rest of the bytes in memory
  std::string_view whole_memory_;
  bool regular_ = true;
  std::optional<uint64_t> size_;
  uint64_t disk_bytes_ = 0;
  std::unique_ptr<XXH3_state_s, Release> hash_;

  std::unique_ptr<z_stream_s, Release> inflate_;  // null for plain files
  std::vector<char> compressed_;
  bool inside_member_ = true;

  std::vector<char> buffer_;  // [begin_, end_) is the window
  size_t begin_ = 0, end_ = 0;
  uint64_t offset_ = 0;  // of buffer_[0] in the contents
  uint64_t line_ = 0;
  char newline_ = '\n';
};

}  // namespace teracell::mesher
