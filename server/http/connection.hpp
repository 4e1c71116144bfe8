// One client: its requests one after the other. Each is read, answered at once or by the pool, and sent. A connection lives on
// its loop's thread; while make_in_pool() runs, a thread of the pool uses it instead.
#pragma once
#include <functional>
#include <list>
#include <optional>
#include <string>
#include <vector>

#include "server/http/head_parser.hpp"
#include "server/http/loop.hpp"
#include "store/base/wanted.hpp"

namespace teracell::server {

// Whose connection it is, and what counts it while it lives.
struct Peer {
  std::shared_ptr<Client> client;
  bool proxy;    // whether its requests name their clients
  bool refused;  // whether it is beyond a limit: its first request is told so, and it is closed
  Counted of_all, of_client;
};

// Whoever waits for the same value makes it, within the time that it has itself.
struct TooDear : Unwanted {
  using Unwanted::Unwanted;
};

// Serves a socket on its loop until one side closes it. Any thread may call it.
void serve_connection(Loop& loop, Socket socket, Peer peer);

class Connection final : public LoopMember {
 public:
  Connection(Loop& loop, Socket socket, Peer peer);
  ~Connection();
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  Awaitable<void> serve();  // returns when the connection is to be closed
  void finish() override;
  void drop_if_late(Clock::time_point now) override;
  Clock::time_point idle_since() const override;
  const Client& client() const override { return *peer_.client; }
  void drop() override;

 private:
  enum State { kIdle, kReading, kMaking, kWriting, kLingering };
  HeadParser::Progress parse();
  asio::mutable_buffer space();
  void enter(State state);
  Awaitable<void> make();
  Awaitable<void> in_pool(Cost cost, std::function<void()> work);
  void make_in_pool();
  void make_part();
  void check_wanted(Clock::time_point began, Clock::time_point& looked) const;
  bool client_has_gone() const;
  std::optional<Response> answer_here();
  Response overloaded(const std::string& message) const;
  bool waits_too_much() const;
  bool holds_too_much() const;
  void hold();
  Response too_much_held() const;
  Awaitable<bool> send();
  Awaitable<bool> next_part();
  Awaitable<bool> write();
  Awaitable<void> linger();
  void receive_no_more();

  const Peer peer_;  // first: counted until all else is gone
  Loop& loop_;
  Shared& shared_;
  Socket socket_;
  std::list<LoopMember*>::iterator place_;
  std::shared_ptr<Client> requester_;  // of the request: the peer's, or the one that the proxy names
  State state_ = kLingering;           // until enter() says otherwise
  Clock::time_point entered_;          // when it got into this state
  std::list<Loop*> busy_{&loop_};      // its place among the client's, while it is not idle
  const std::list<Loop*>::iterator idle_ = busy_.begin();
  bool finishing_ = false;  // we ended receiving ourselves: an end of input does not mean that the client left
  Clock::time_point deadline_;
  std::string client_, local_;

  std::vector<char> buffer_;
  size_t begin_ = 0, end_ = 0;  // of the bytes in buffer_ that were read and not yet used
  Head head_;
  std::optional<HeadParser> parser_;
  Request request_;
  Response response_;
  Counted held_, held_by_client_;  // bytes of the response's body
  std::string out_;  // the response's head, or that of a chunk
  size_t sent_ = 0, body_sent_ = 0;  // bytes of the response, and of its body
  size_t goal_ = 0;                  // sent_ has to reach it ...
  Clock::time_point due_;            // ... by this time
  bool chunked_ = false;
  bool cut_ = false;                 // a part of the response could not be made
  bool keep_ = true;
};

}  // namespace teracell::server
