#include "tools/mpi/ranks.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

#include <unistd.h>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::mpi {

Ranks::Ranks(int& argc, char**& argv) : parent_(::getppid()) {
  int provided;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here_);
  MPI_Comm_size(here_, &on_this_machine_);
}

Ranks::~Ranks() {
  MPI_Comm_free(&here_);
  MPI_Finalize();
}

std::string Ranks::name() const {
  char host[MPI_MAX_PROCESSOR_NAME];
  int length = 0;
  MPI_Get_processor_name(host, &length);
  return fmt::format("rank {} ({})", rank_, std::string_view(host, static_cast<size_t>(length)));
}

void Ranks::expect_own_launcher() const {
  for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"})
    if (const char* launched = std::getenv(variable); size_ == 1 && launched && std::atoi(launched) > 1)
      throw UsageError(
          fmt::format("expected {} ranks, found 1: the launcher is that of another MPI; start the program with the mpirun of the MPI that "
                      "it was built with",
                      launched));
}

bool Ranks::is_orphan() const { return size_ > 1 && ::getppid() != parent_; }

int Ranks::with_same(std::span<const uint8_t> bytes) const {
  const auto size = static_cast<int>(bytes.size());
  Bytes all(bytes.size() * static_cast<size_t>(on_this_machine_));
  MPI_Allgather(bytes.data(), size, MPI_BYTE, all.data(), size, MPI_BYTE, here_);
  int same = 0;
  for (size_t i = 0; i < all.size(); i += bytes.size()) same += std::equal(bytes.begin(), bytes.end(), all.begin() + static_cast<ptrdiff_t>(i));
  return same;
}

int Ranks::least(int number) const {
  int out;
  MPI_Allreduce(&number, &out, 1, MPI_INT, MPI_MIN, MPI_COMM_WORLD);
  return out;
}

void Ranks::send(int to, Tag tag, Bytes body) {
  Sending& s = sending_.emplace_back(std::move(body), MPI_REQUEST_NULL);
  MPI_Isend(s.body.data(), static_cast<int>(s.body.size()), MPI_BYTE, to, static_cast<int>(tag), MPI_COMM_WORLD, &s.request);
}

void Ranks::send_all(Tag tag, const Bytes& body) {
  for (int to = 0; to < size_; ++to) send(to, tag, body);
}

bool Ranks::sent_all() {
  std::erase_if(sending_, [](Sending& s) {
    int done;
    MPI_Test(&s.request, &done, MPI_STATUS_IGNORE);
    return done != 0;
  });
  return sending_.empty();
}

std::optional<Message> Ranks::receive() {
  sent_all();
  int there, bytes;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
  if (!there) return std::nullopt;
  MPI_Get_count(&status, MPI_BYTE, &bytes);
  Message out{status.MPI_SOURCE, static_cast<Tag>(status.MPI_TAG), Bytes(static_cast<size_t>(bytes))};
  MPI_Recv(out.body.data(), bytes, MPI_BYTE, status.MPI_SOURCE, status.MPI_TAG, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  return out;
}

void Ranks::abort(int status) {
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // launchers drop what they have not passed on yet of a message on stderr
  MPI_Abort(MPI_COMM_WORLD, status);
  std::_Exit(status);
}

std::string take_text(ByteReader& in) {
  const auto bytes = in.take_sized();
  return {bytes.begin(), bytes.end()};
}

}  // namespace teracell::mpi
