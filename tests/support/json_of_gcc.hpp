// Included before all else where clang compiles libraries for tests that GCC has compiled (TERACELL_COMPILED_TESTS): objects of JSON have no room
// for an empty member there. nlohmann_json asks for this in a way that only GCC affirms.
#pragma once
#include <nlohmann/detail/macro_scope.hpp>
#undef JSON_NO_UNIQUE_ADDRESS
#define JSON_NO_UNIQUE_ADDRESS [[no_unique_address]]
