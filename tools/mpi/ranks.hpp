// The processes of a job and their messages, by MPI. One thread of each process uses this. Nothing here waits within MPI, whose blocking
// calls keep a core busy: who waits sleeps between two calls of receive().
#pragma once
#include <mpi.h>

#include <list>
#include <optional>
#include <span>
#include <string>

#include "store/base/bytes.hpp"

namespace teracell::mpi {

// What a message says. To rank 0, unless it says otherwise.
enum class Tag : int {
  kSee,       // to all: here is a file, can you see it?
  kPrepared,  // the surfaces are read; this is what I found
  kAsk,       // what shall I make next?
  kMake,      // to one that asked: this piece, or nothing more
  kMade,      // this piece is made
  kCopy,      // to one: the bytes of this piece go to these places
  kCopied,    // they are there
  kSync,      // to all: make durable what you copied
  kSynced,    // it is
  kEnd,       // to all: the grid is in place, and the files of pieces can go
  kFailed,    // this went wrong
};

struct Message {
  int from;
  Tag tag;
  Bytes body;
};

class Ranks {
 public:
  Ranks(int& argc, char**& argv);
  ~Ranks();
  Ranks(const Ranks&) = delete;
  int rank() const { return rank_; }
  int size() const { return size_; }
  int on_this_machine() const { return on_this_machine_; }  // ranks that share its memory, this one among them
  std::string name() const;                                 // "rank 3 (host)"
  // Throws UsageError when the launcher of another MPI has started processes that each believe to be alone.
  void expect_own_launcher() const;
  // Whether what has started this process is gone, and with it the job. MPI does not always notice.
  bool is_orphan() const;
  // How many ranks on this machine have these bytes, this one among them. All of them must call it, with as many bytes.
  int with_same(std::span<const uint8_t> bytes) const;
  // The least of the numbers that the ranks have. All of them must call it.
  int least(int number) const;

  void send(int to, Tag tag, Bytes body = {});
  void send_all(Tag tag, const Bytes& body = {});
  std::optional<Message> receive();  // if one is there
  bool sent_all();                   // whether all messages have left
  [[noreturn]] void abort(int status);  // ends all processes

 private:
  struct Sending {
    Bytes body;
    MPI_Request request;
  };
  const pid_t parent_;
  MPI_Comm here_;  // the ranks on this machine
  int rank_ = 0, size_ = 1, on_this_machine_ = 1;
  std::list<Sending> sending_;
};

std::string take_text(ByteReader& in);

}  // namespace teracell::mpi
