// Included before every source of the module: what the libraries of Debian's Emscripten 3.1 (libc++ 13) do
// not have yet, above all the algorithms over ranges. All of it means what it means in the standard. When these libraries have it, this file
// can go; until then nothing else needs to know which compiler it is read by.
#pragma once
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <memory>
#include <ranges>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#if _LIBCPP_VERSION < 15000
namespace std {

template <class To, class From>
To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

template <class T>
unique_ptr<T> make_unique_for_overwrite(size_t n) {
  return unique_ptr<T>(new remove_extent_t<T>[n]);
}

// Of what is not a number in the C locale it reads nothing; signs, blanks and hexadecimal digits at the start are none.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
  const char* stop = first;
  while (stop != last && (isdigit(static_cast<unsigned char>(*stop)) || *stop == '.' || *stop == 'e' || *stop == 'E' || *stop == '+' || *stop == '-'))
    ++stop;
  const string text(first, stop);
  char* end = nullptr;
  if (text.empty() || text[0] == '+') return {first, errc::invalid_argument};
  const double number = strtod(text.c_str(), &end);
  if (end == text.c_str()) return {first, errc::invalid_argument};
  const char* const read = first + (end - text.c_str());
  if (number == HUGE_VAL || number == -HUGE_VAL) return {read, errc::result_out_of_range};
  value = number;
  return {read, errc{}};
}

// No thread can be started here; what would be one throws, as std::thread does.
class jthread {
 public:
  jthread() = default;
  template <class... A>
  explicit jthread(A&&...) {
    throw system_error(make_error_code(errc::resource_unavailable_try_again));
  }
};

}  // namespace std
namespace std::ranges {

template <class In, class Out>
struct in_out_result {
  In in;
  Out out;
};

namespace polyfill {
template <class Compare, class Projection>
auto by(Compare& compare, Projection& projection) {
  return [&](auto&& a, auto&& b) -> bool {
    return std::invoke(compare, std::invoke(projection, std::forward<decltype(a)>(a)), std::invoke(projection, std::forward<decltype(b)>(b)));
  };
}
template <class Predicate, class Projection>
auto of(Predicate& predicate, Projection& projection) {
  return [&](auto&& a) -> bool { return std::invoke(predicate, std::invoke(projection, std::forward<decltype(a)>(a))); };
}
// Stable, and a fraction of the size of the library's two ways to sort, which are compiled for each kind of values.
template <class It, class Less>
void merge_sort(It first, It last, const Less& less) {
  using T = typename std::iterator_traits<It>::value_type;
  if (last - first <= 16) {
    for (It i = first; i != last; ++i) {
      T value = std::move(*i);
      It to = i;
      for (; to != first && less(value, to[-1]); --to) *to = std::move(to[-1]);
      *to = std::move(value);
    }
    return;
  }
  const It middle = first + (last - first) / 2;
  merge_sort(first, middle, less);
  merge_sort(middle, last, less);
  std::vector<T> lower(std::make_move_iterator(first), std::make_move_iterator(middle));
  It upper = middle;
  for (auto i = lower.begin(); i != lower.end(); ++first) *first = upper != last && less(*upper, *i) ? std::move(*upper++) : std::move(*i++);
}
}  // namespace polyfill

template <class R, class C = less, class P = identity>
void sort(R&& r, C compare = {}, P projection = {}) {
  polyfill::merge_sort(std::begin(r), std::end(r), polyfill::by(compare, projection));
}
template <class R, class C = less, class P = identity>
void stable_sort(R&& r, C compare = {}, P projection = {}) {
  polyfill::merge_sort(std::begin(r), std::end(r), polyfill::by(compare, projection));
}
template <class R, class C = less, class P = identity>
auto max_element(R&& r, C compare = {}, P projection = {}) {
  return std::max_element(std::begin(r), std::end(r), polyfill::by(compare, projection));
}
template <class R, class C = less, class P = identity>
auto min_element(R&& r, C compare = {}, P projection = {}) {
  return std::min_element(std::begin(r), std::end(r), polyfill::by(compare, projection));
}
template <class R, class C = less, class P = identity>
auto max(R&& r, C compare = {}, P projection = {}) {
  return *ranges::max_element(r, compare, projection);
}
template <class R, class T, class C = less, class P = identity>
auto lower_bound(R&& r, const T& value, C compare = {}, P projection = {}) {
  return std::lower_bound(std::begin(r), std::end(r), value,
                          [&](auto&& a, const T& b) -> bool { return std::invoke(compare, std::invoke(projection, a), b); });
}
template <class R, class T, class C = less, class P = identity>
auto upper_bound(R&& r, const T& value, C compare = {}, P projection = {}) {
  return std::upper_bound(std::begin(r), std::end(r), value,
                          [&](const T& a, auto&& b) -> bool { return std::invoke(compare, a, std::invoke(projection, b)); });
}
template <class R, class F, class P = identity>
auto find_if(R&& r, F predicate, P projection = {}) {
  return std::find_if(std::begin(r), std::end(r), polyfill::of(predicate, projection));
}
template <class R, class T, class P = identity>
auto find(R&& r, const T& value, P projection = {}) {
  return std::find_if(std::begin(r), std::end(r), [&](auto&& a) -> bool { return std::invoke(projection, a) == value; });
}
template <class R, class F, class P = identity>
bool any_of(R&& r, F predicate, P projection = {}) {
  return std::any_of(std::begin(r), std::end(r), polyfill::of(predicate, projection));
}
template <class R, class F, class P = identity>
bool none_of(R&& r, F predicate, P projection = {}) {
  return std::none_of(std::begin(r), std::end(r), polyfill::of(predicate, projection));
}
template <class R, class F, class P = identity>
bool all_of(R&& r, F predicate, P projection = {}) {
  return std::all_of(std::begin(r), std::end(r), polyfill::of(predicate, projection));
}
template <class R, class T, class P = identity>
auto count(R&& r, const T& value, P projection = {}) {
  return std::count_if(std::begin(r), std::end(r), [&](auto&& a) -> bool { return std::invoke(projection, a) == value; });
}
template <class R, class F = equal_to, class P = identity>
auto adjacent_find(R&& r, F predicate = {}, P projection = {}) {
  return std::adjacent_find(std::begin(r), std::end(r), polyfill::by(predicate, projection));
}
template <class R1, class R2, class F = equal_to, class P1 = identity, class P2 = identity>
bool equal(R1&& a, R2&& b, F predicate = {}, P1 p1 = {}, P2 p2 = {}) {
  return std::equal(std::begin(a), std::end(a), std::begin(b), std::end(b), [&](auto&& x, auto&& y) -> bool {
    return std::invoke(predicate, std::invoke(p1, std::forward<decltype(x)>(x)), std::invoke(p2, std::forward<decltype(y)>(y)));
  });
}
template <class R, class Out>
auto copy(R&& r, Out out) {
  auto last = std::copy(std::begin(r), std::end(r), std::move(out));
  return in_out_result<iterator_t<R>, Out>{std::end(r), std::move(last)};
}
template <class R, class T>
void replace(R&& r, const T& old_value, const T& new_value) {
  std::replace(std::begin(r), std::end(r), old_value, new_value);
}
template <class R, class F, class T>
void replace_if(R&& r, F predicate, const T& new_value) {
  std::replace_if(std::begin(r), std::end(r), predicate, new_value);
}
template <class R1, class R2, class Out>
void set_union(R1&& a, R2&& b, Out out) {
  std::set_union(std::begin(a), std::end(a), std::begin(b), std::end(b), out);
}

}  // namespace std::ranges
#endif
