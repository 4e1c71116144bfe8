// The facets of all shapes of a STEP file, as teracell-step writes them and teracell reads them, on one machine: numbers are in its byte order.
//
//   8 bytes       kFacetsMagic
//   8             the bytes of the head
//   the head      JSON: "shapes", of each one "vertices" and "groups" ("color": of faces that have one of their own, else ""; "triangles"), and
//                 "faces_without_facets", "closed", "facet_volume", "facet_area", "kernel_volume" (or null)
//   of each shape 3 doubles for each vertex, then for each triangle of its groups 3 32-bit numbers of vertices
//
// Lengths are in millimetres. This header has nothing but constants, since the two programs share no library.
#pragma once
#include <string_view>

namespace teracell::mesher {

// It is in the keys of the cache, too. Its digit is raised when the layout changes, and when other facets are made of the same file.
inline constexpr std::string_view kFacetsMagic = "teracad3";
// Below it the kernel takes two points for one: no deflection is smaller.
inline constexpr double kLeastDeflection = 1e-7;

}  // namespace teracell::mesher
