// What this program asks of an operating system beyond POSIX, by means of POSIX: right everywhere, and less good than what one system offers.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace teracell::inline store::portable {

int cores();                  // that the calling thread may run on, at least 1
std::string core_set();       // which ones these are, for comparing; empty: not known
uint64_t memory();            // bytes that this process may take
uint64_t resident_bytes();    // that this process takes
uint64_t peak_bytes();        // the most that it has taken
uint64_t open_descriptors();
std::filesystem::path own_program();  // the file that runs; empty: not known

// A hint: as few heaps as this for all threads.
void limit_heaps(int heaps);
// A hint: so many bytes of the heap are going to be used again and again. The heap grows to them at once, in huge pages as far as the system has them
// at hand, and keeps them when they are freed; the heap of each other thread may keep as many. For a program that does one thing, not for a library:
// it changes malloc(). (Meshing a small grid took 0.7 of the time.)
void make_heap(size_t bytes);
// A hint: memory that was freed is the system's again, if the process takes more than `most` bytes.
void give_back_memory(uint64_t most);
// A hint: the disk may begin to write this part of a file.
void begin_write_back(int file, uint64_t offset, uint64_t bytes);
// A hint: these pages are about to be filled.
void populate(void* memory, size_t bytes);
// A hint: memory from a multiple of kHugePage on, of a multiple of its size, may be made of huge pages, as far as the system has them at hand.
// (Such memory is filled in half of the time. Where the system must first make a huge page of small ones, that costs several times as much.)
inline constexpr size_t kHugePage = size_t{1} << 21;
void prefer_huge_pages(void* memory, size_t bytes);

// The descriptor of a file for reading and writing that has no name; -1, with errno, if there can be none in the folder.
int file_without_name(const std::filesystem::path& folder);
// The same in memory; -1 where there is no such thing.
int file_in_memory();
// Gives a folder another name. With `exchange` a folder of this name takes the old one in return. 0, or errno.
int rename_folder(const std::filesystem::path& from, const std::filesystem::path& to, bool exchange);

}  // namespace teracell::store::portable
