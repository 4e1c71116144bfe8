// Places where a plane is wanted, and which of them are kept.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

namespace teracell::mesher {

struct Candidate {
  enum class Rank { kSide, kFixed, kFace };  // the first are kept before the others
  double at;
  Rank rank;
  double area = 0;  // of a face
  size_t body = 0;
};

// A candidate that is nearer than `finest` to one that was kept.
struct Loss {
  Candidate lost, kept;
};

struct Kept {
  std::vector<double> at;  // in ascending order
  std::vector<Loss> losses;
};

// Larger faces go before smaller ones, and lesser coordinates before greater ones; areas that follow each other within 1e-9 of themselves are equal,
// and of what is equal in all the first in the list goes first. What is within `same` of a kept candidate is no loss.
Kept merged(std::vector<Candidate> candidates, double finest, double same);

}  // namespace teracell::mesher
