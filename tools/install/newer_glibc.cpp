// What archives of Debian 12 use of a glibc that is newer than the oldest on which a release runs (tools/release).
#include <link.h>
#include <sys/random.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>

extern "C" {

// glibc 2.32. libstdc++ counts references without atomic operations where this says so; it never does.
[[gnu::visibility("hidden")]] extern const char __libc_single_threaded;
const char __libc_single_threaded = 0;

// glibc 2.36, for the seeds of Expat's tables and for std::random_device.
[[gnu::visibility("hidden")]] void arc4random_buf(void* bytes, std::size_t size) {
  for (auto* at = static_cast<unsigned char*>(bytes); size > 0;) {
    const std::size_t some = std::min<std::size_t>(size, 256);  // the most that is given at once
    if (getentropy(at, some) != 0) std::abort();
    at += some;
    size -= some;
  }
}
[[gnu::visibility("hidden")]] std::uint32_t arc4random() {
  std::uint32_t number = 0;
  arc4random_buf(&number, sizeof number);
  return number;
}

// glibc 2.35, where libgcc finds the table of what to do when an exception passes `address`. Of what is found, libgcc reads the table alone.
struct dl_find_object {
  unsigned long long flags;
  void *begin, *end;
  link_map* object;
  void* table;
};
[[gnu::visibility("hidden")]] int _dl_find_object(void* address, dl_find_object* found) {
  struct Search {
    std::uintptr_t address;
    dl_find_object* found;
  } search{reinterpret_cast<std::uintptr_t>(address), found};
  const auto look = [](dl_phdr_info* object, std::size_t, void* data) {
    auto& [wanted, result] = *static_cast<Search*>(data);
    const ElfW(Phdr)* table = nullptr;
    bool inside = false;
    for (const ElfW(Phdr)* part = object->dlpi_phdr; part != object->dlpi_phdr + object->dlpi_phnum; ++part) {
      if (part->p_type == PT_LOAD) inside |= wanted - (object->dlpi_addr + part->p_vaddr) < part->p_memsz;
      if (part->p_type == PT_GNU_EH_FRAME) table = part;
    }
    if (!inside || table == nullptr) return 0;
    result->table = reinterpret_cast<void*>(object->dlpi_addr + table->p_vaddr);
    return 1;
  };
  return dl_iterate_phdr(look, &search) == 1 ? 0 : -1;
}

}  // extern "C"
