// What a reader of surface files is told besides the file and the part. A format that needs more, such as a tolerance, gets a
// field here, with a default that suits the other formats.
#pragma once
#include "mesher/surface/spill.hpp"

namespace teracell {

class Background;

struct ReadOptions {
  Budget budget;                 // vertices that must be kept stay within it; others are kept on disk
  Background* helper = nullptr;  // may do part of the parsing; it may have other jobs
};

}  // namespace teracell
