// The same as in portable.hpp, by what Linux has.
#pragma once
#include "store/base/system/portable.hpp"

namespace teracell::inline store::linux_only {

int cores();
std::string core_set();
uint64_t memory();
uint64_t resident_bytes();
uint64_t peak_bytes();
uint64_t open_descriptors();
std::filesystem::path own_program();
void limit_heaps(int heaps);
void make_heap(size_t bytes);
void give_back_memory(uint64_t most);
void begin_write_back(int file, uint64_t offset, uint64_t bytes);
void populate(void* memory, size_t bytes);
using portable::kHugePage;
void prefer_huge_pages(void* memory, size_t bytes);
int file_without_name(const std::filesystem::path& folder);
int file_in_memory();
int rename_folder(const std::filesystem::path& from, const std::filesystem::path& to, bool exchange);

}  // namespace teracell::store::linux_only
