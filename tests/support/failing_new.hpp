// Lets memory run out.
#pragma once

namespace teracell {

// How many allocations of this thread succeed before one fails; negative: none does. Without effect under a sanitizer, which has an
// `operator new` of its own.
inline thread_local int allocations_left = -1;

}  // namespace teracell
