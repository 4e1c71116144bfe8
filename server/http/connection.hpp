// One client: its requests one after the other, each read, answered at once or by the pool, and sent. Lives on its loop's
// thread; only what make_in_pool() touches is a pool thread's meanwhile.
#pragma once
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "server/http/head_parser.hpp"
#include "server/http/loop.hpp"

namespace teracell {

class Connection {
 public:
  Connection(Loop& loop, Socket socket, Counted open);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  Awaitable<void> serve();  // until one side has had enough
  void finish();            // what is under way is still answered
  void drop_if_late(Clock::time_point now);

 private:
  enum State { kIdle, kReading, kMaking, kWriting, kLingering };
  HeadParser::Progress parse();
  asio::mutable_buffer space();
  Awaitable<void> make();
  Awaitable<void> make_in_pool();
  std::optional<Response> answer_here();
  Response overloaded(const std::string& message) const;
  bool holds_too_much() const;
  Response too_much_held() const;
  Awaitable<bool> send();
  Awaitable<void> linger();
  void receive_no_more();

  const Counted open_;  // first: counted until all else is gone
  Loop& loop_;
  Shared& shared_;
  Socket socket_;
  std::list<Connection*>::iterator place_;
  State state_ = kIdle;
  bool finishing_ = false;  // the end of what is received is our own doing
  Clock::time_point deadline_;
  std::string client_, local_;

  std::vector<char> buffer_;
  size_t begin_ = 0, end_ = 0;  // what was read and not yet used
  Head head_;
  std::optional<HeadParser> parser_;
  Request request_;
  Response response_;
  Counted held_;                // the bytes of its body
  std::string out_;             // its head
  size_t body_sent_ = 0;
  bool keep_ = true;
};

}  // namespace teracell
