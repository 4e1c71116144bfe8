// Exact sums and products of doubles as expansions: sums of non-overlapping doubles, smallest first.
// J. R. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates" (1997).
//
// REQUIRES: rounding to nearest, no fused or reordered operations, and no overflow or underflow. Coordinates are 0 or have a
// magnitude in [1e-75, 1e75] (facet.hpp, grid.cpp), so products of three and their rounding errors stay within the normal range.
//
// Components that are zero are dropped. On a lattice, where differences are exact, expansions cost little more than doubles.
#pragma once

namespace teracell::mesher {

template <int N>
struct Expansion {
  double part[N];
  int size = 0;

  void push(double x) {
    if (x != 0) part[size++] = x;
  }
  int sign() const { return size == 0 ? 0 : part[size - 1] > 0 ? 1 : -1; }  // that of the largest part
};

// a + b = sum + error, exactly (Knuth).
inline void two_sum(double a, double b, double& sum, double& error) {
  sum = a + b;
  const double b_part = sum - a;
  error = (a - (sum - b_part)) + (b - b_part);
}

// a * b = product + error, exactly (Dekker, Veltkamp).
inline void two_product(double a, double b, double& product, double& error) {
  constexpr double kSplit = 134217729.0;  // 2^27 + 1
  product = a * b;
  const double ca = kSplit * a, cb = kSplit * b;
  const double a_hi = ca - (ca - a), b_hi = cb - (cb - b);
  const double a_lo = a - a_hi, b_lo = b - b_hi;
  error = a_lo * b_lo - (((product - a_hi * b_hi) - a_lo * b_hi) - a_hi * b_lo);
}

inline Expansion<2> difference(double a, double b) {
  double sum, error;
  two_sum(a, -b, sum, error);
  Expansion<2> e;
  e.push(error);
  e.push(sum);
  return e;
}

template <int N, int M>
Expansion<N + M> operator+(const Expansion<N>& e, const Expansion<M>& f) {
  Expansion<N + M> out;
  for (int i = 0; i < e.size; ++i) out.part[i] = e.part[i];
  out.size = e.size;
  for (int j = 0; j < f.size; ++j) {  // one part at a time
    double q = f.part[j];
    int kept = 0;
    for (int i = 0; i < out.size; ++i) {
      double error;
      two_sum(q, out.part[i], q, error);
      if (error != 0) out.part[kept++] = error;
    }
    if (q != 0) out.part[kept++] = q;
    out.size = kept;
  }
  return out;
}

template <int N>
Expansion<N> operator-(Expansion<N> e) {
  for (int i = 0; i < e.size; ++i) e.part[i] = -e.part[i];
  return e;
}

template <int N, int M>
Expansion<N + M> operator-(const Expansion<N>& e, const Expansion<M>& f) {
  return e + -f;
}

template <int N, int M>
Expansion<2 * N * M> operator*(const Expansion<N>& e, const Expansion<M>& f) {
  Expansion<2 * N * M> out;
  for (int j = 0; j < f.size; ++j) {
    for (int i = 0; i < e.size; ++i) {
      double product, error;
      two_product(e.part[i], f.part[j], product, error);
      for (double q : {error, product}) {
        if (q == 0) continue;
        int kept = 0;
        for (int k = 0; k < out.size; ++k) {
          double rest;
          two_sum(q, out.part[k], q, rest);
          if (rest != 0) out.part[kept++] = rest;
        }
        if (q != 0) out.part[kept++] = q;
        out.size = kept;
      }
    }
  }
  return out;
}

}  // namespace teracell::mesher
