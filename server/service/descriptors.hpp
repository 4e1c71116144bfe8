// How the descriptors that the system allows a process are shared out.
#pragma once
#include <cstdint>

namespace teracell::server {

struct DescriptorShares {
  uint64_t connections;
  uint64_t files;   // of grids, kept open
  uint64_t others;  // needed whatever is served
  uint64_t all() const { return connections + files + others; }
};

// What a server would like to have: `open` are open already.
DescriptorShares wanted_descriptors(uint64_t connections, uint64_t grids, uint64_t threads, uint64_t open);

// As much of it as is allowed. Files give way before connections, but keep a quarter. Throws IoError when that is too little to serve.
DescriptorShares allowed_descriptors(const DescriptorShares& wanted, uint64_t allowed);

// As much as is allowed once the limit is raised, as far as it is useful and the system permits.
DescriptorShares share_descriptors(const DescriptorShares& wanted);

}  // namespace teracell::server
