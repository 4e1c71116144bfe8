// The facets of all shapes of a model, in the file from which teracell takes them (mesher/cad/facets_file.hpp says what is in it).
#pragma once
#include <functional>
#include <string>

#include "tools/step/model.hpp"

namespace teracell::step {

struct Tolerances {
  double deflection;  // millimetres
  double angle;       // degrees
  int threads;
};

// `progress` gets the share of the work that is done. Throws std::runtime_error when the file can't be written.
void write_facets(const Model& model, const Tolerances& tolerances, const std::string& path, const std::function<void(double)>& progress);

}  // namespace teracell::step
