// The bytes of a surface file, plain or gzip: read once from front to back through one window, hashed as they lie on
// disk. Plain files are read(2) block by block rather than mapped: mapped pages count as this process's memory, and a
// mesh may be larger than the machine. Inflated gzip (several members, zero padding after the last) looks the same.
//
// Not to be shared by threads. Views into the window hold until the next call that reads.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

struct XXH3_state_s;
struct z_stream_s;

namespace teracell {

class Input {
 public:
  // Throws IoError when the file can't be opened or read.
  explicit Input(const std::filesystem::path& path);
  // Over bytes in memory, which must outlive it. `name` stands for the file in messages.
  Input(std::string name, std::string_view bytes);
  ~Input();
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  const std::string& name() const { return name_; }
  bool compressed() const { return inflate_ != nullptr; }
  // Of the contents; unknown when they are compressed or come through a pipe.
  std::optional<uint64_t> size() const { return size_; }
  bool regular() const { return regular_; }  // it can be read again: no pipe, no device
  // Bytes of the contents taken so far.
  uint64_t offset() const { return offset_ + begin_; }

  // The bytes that come next: at least `want`, fewer only when the contents end. REQUIRES: want <= kWindow.
  static constexpr size_t kWindow = size_t{1} << 18;
  std::string_view window(size_t want) {
    if (end_ - begin_ < want) fill(want);
    return {buffer_.data() + begin_, end_ - begin_};
  }
  // REQUIRES: n <= window(0).size().
  void consume(size_t n) { begin_ += n; }
  // The same for `n` bytes that are so many whole lines.
  void consume_lines(size_t n, uint64_t lines) {
    consume(n);
    line_ += lines;
  }

  // A line is held in memory whole. Polygons of a million vertices fit; a file of zeros doesn't fill the machine.
  static constexpr size_t kLongestLine = size_t{1} << 24;
  // The next line without its end ("\n" or "\r\n"); the last line needs none. False at the end of the contents.
  bool next_line(std::string_view& line);
  // '\r' for texts of old Macintosh programs.
  void set_newline(char c) { newline_ = c; }

  // The number of the line given last, from 1.
  uint64_t line() const { return line_; }
  // Where we are, for messages: "hull.stl: line 7" (the line given last), "hull.stl: byte 84".
  std::string at_line() const;
  std::string at_byte(uint64_t offset) const;
  std::string at_byte() const { return at_byte(offset()); }

  // Of the file as it lies on disk; complete once window(1) is empty.
  uint64_t bytes_on_disk() const { return disk_bytes_; }
  std::string hash() const;  // XXH3-128, 32 hex digits as xxhsum prints them

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
  int descriptor_ = -1;      // or
  std::string_view memory_;  // what is left of the bytes in memory
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

}  // namespace teracell
