// SPDX-License-Identifier: MIT
//
// shortest.h: the shortest decimal number that reads back as a given double: the text of std::to_chars in two
// thirds of its time, for numbers of everyday size.
//
// R. Giulietti, "The Schubfach way to render doubles", 2020: the double and the ends of the interval that rounds to it
// are scaled by one power of ten, kept to 126 bits, and compared as integers. Only powers that are exact in 126 bits
// are needed here; other numbers are left to std::to_chars.
#pragma once

#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>

#include "src/base/bytes.h"

namespace alcap::detail {

/// Room for the text of any double or 64-bit integer.
inline constexpr std::size_t longest_number = 24;

namespace shortest {

__extension__ using Wide = unsigned __int128;

/// digits 10^exponent, at most 17 digits.
struct Decimal {
  std::uint64_t digits;
  int exponent;
};

inline constexpr int largest_power = 37;

/// 10^k shifted to 126 bits, plus one.
inline constexpr auto powers = [] {
  std::array<Wide, largest_power + 1> table = {};
  Wide power = 1;
  for (Wide& entry : table) {
    Wide scaled = power;
    while (scaled >> 125 == 0) scaled <<= 1;
    entry = scaled + 1;
    power *= 10;
  }
  return table;
}();

/// floor(k log2(10)) and floor(q log10(2)) for small k and q; the last for 3/4 of the power.
inline constexpr int log2_of_power(int k) { return static_cast<int>((std::int64_t{k} * 913124641741) >> 38); }
inline constexpr int log10_of_power(int q) { return static_cast<int>((std::int64_t{q} * 661971961083) >> 41); }
inline constexpr int log10_of_three_quarters(int q) {
  return static_cast<int>((std::int64_t{q} * 661971961083 - 274743187321) >> 41);
}

/// The product of g and c without its lowest 126 bits, the last bit saying whether any of them was set.
inline std::uint64_t round_to_odd(Wide g, std::uint64_t c) {
  constexpr Wide low63 = (Wide{1} << 63) - 1;
  const auto g1 = static_cast<std::uint64_t>(g >> 63), g0 = static_cast<std::uint64_t>(g & low63);
  const auto x1 = static_cast<std::uint64_t>((Wide{g0} * c) >> 64);
  const Wide y = Wide{g1} * c;
  const auto y0 = static_cast<std::uint64_t>(y), y1 = static_cast<std::uint64_t>(y >> 64);
  const std::uint64_t z = (y0 >> 1) + x1;
  const std::uint64_t w = y1 + (z >> 63);
  constexpr std::uint64_t mask = (std::uint64_t{1} << 63) - 1;
  return w | (((z & mask) + mask) >> 63);
}

/// c 2^q, c in [2^52, 2^53), q in [-122, -3].
inline Decimal decimal(std::uint64_t c, int q) {
  const bool regular = c != std::uint64_t{1} << 52;  // the doubles below are as far apart as those above
  const std::uint64_t odd = c & 1;
  const std::uint64_t middle = 4 * c, upper = middle + 2, lower = middle - (regular ? 2 : 1);
  const int k = regular ? log10_of_power(q) : log10_of_three_quarters(q);
  const int h = q + log2_of_power(-k) + 2;
  const Wide g = powers[static_cast<std::size_t>(-k)];
  const std::uint64_t v = round_to_odd(g, middle << h), left = round_to_odd(g, lower << h),
                      right = round_to_odd(g, upper << h);
  // A multiple of ten where exactly one of the two around lies inside, or else the nearer of the two numbers inside.
  // Without branches: which it is cannot be predicted.
  const std::uint64_t s = v >> 2, tens = 10 * (s / 10), half = (s << 2) + 2;
  const bool down = left + odd <= tens << 2, up = ((tens + 10) << 2) + odd <= right;
  const bool floor_in = left + odd <= s << 2, ceiling_in = ((s + 1) << 2) + odd <= right;
  const bool nearer_above = (v > half) | ((v == half) & ((s & 1) != 0));
  const bool above = floor_in != ceiling_in ? ceiling_in : nearer_above;
  const std::uint64_t ten = tens + (up ? 10 : 0), one = s + (above ? 1 : 0);
  return {down != up ? ten : one, k};
}

/// Eight digits, leading zeros included: halved three times, all parts at once.
inline void put_eight(char* to, std::uint64_t value) {
  const std::uint64_t fours = value / 10000 | value % 10000 << 32;
  const std::uint64_t hundreds = fours * 10486 >> 20 & 0x7F0000007F;  // n / 100 for n < 10^4
  const std::uint64_t twos = hundreds | (fours - 100 * hundreds) << 16;
  const std::uint64_t tens = twos * 103 >> 10 & 0x000F000F000F000F;  // n / 10 for n < 100
  const auto text = little_endian(0x3030303030303030 + (tens | (twos - 10 * tens) << 8));
  std::memcpy(to, text.data(), text.size());
}

inline constexpr std::uint64_t ten8 = 100000000, ten16 = ten8 * ten8;

/// 17 digits, zeros in front.
inline void put_digits(char* to, std::uint64_t digits) {
  *to = static_cast<char>('0' + digits / ten16);
  put_eight(to + 1, digits / ten8 % ten8);
  put_eight(to + 9, digits % ten8);
}

/// A number like 0.00123, with so many zeros behind the point: its digits go straight to where they belong. Null where
/// a single digit is left: that may be shorter in the scientific form.
inline char* put_below_one(char* to, bool negative, std::uint64_t digits, int length, int zeros) {
  char* const start = to + (negative ? 1 : 0);
  char* end = start + 2 + zeros + length;
  *to = '-';
  std::memcpy(start, "0.000", 5);
  put_digits(end - 17, digits);
  start[1] = '.';  // a zero in front of 16 digits may have been put there
  while (end[-1] == '0') --end;
  return end - start > 2 + zeros + 1 ? end : nullptr;
}

/// d.ddde-05 of `count` digits.
inline char* put_scientific(char* to, const char* digits, int count, int exponent) {
  *to++ = *digits;
  if (count > 1) {
    *to++ = '.';
    std::memcpy(to, digits + 1, static_cast<std::size_t>(count - 1));
    to += count - 1;
  }
  *to++ = 'e';
  *to++ = '-';
  *to++ = static_cast<char>('0' + exponent / 10);
  *to++ = static_cast<char>('0' + exponent % 10);
  return to;
}

/// ddd.ddd with `whole` digits before the point, or 0.000ddd for whole <= 0.
inline char* put_fixed(char* to, const char* digits, int count, int whole) {
  if (whole > 0) {
    std::memcpy(to, digits, static_cast<std::size_t>(whole));
    to += whole;
    *to++ = '.';
    digits += whole;
    count -= whole;
  } else {
    std::memcpy(to, "0.000", 5);
    to += 2 - whole;
  }
  std::memcpy(to, digits, static_cast<std::size_t>(count));
  return to + count;
}

}  // namespace shortest

/// std::to_chars(to, to + longest_number, value).ptr
inline char* put_shortest(char* to, double value) {
  const auto slowly = [&] { return std::to_chars(to, to + longest_number, value).ptr; };
  const auto bits = std::bit_cast<std::uint64_t>(value);
  const int q = static_cast<int>((bits >> 52) & 0x7FF) - 1075;
  constexpr std::uint64_t fraction = (std::uint64_t{1} << 52) - 1;
  if (q < -122 || q > -3) return slowly();
  const shortest::Decimal decimal = shortest::decimal((bits & fraction) | (fraction + 1), q);
  const std::uint64_t digits = decimal.digits;
  const bool negative = bits >> 63 != 0;

  const int length = digits >= shortest::ten16 ? 17 : 16;
  const int zeros = -length - decimal.exponent;
  if (digits >= shortest::ten16 / 10 && zeros >= 0 && zeros <= 3) {
    char* const end = shortest::put_below_one(to, negative, digits, length, zeros);
    return end != nullptr ? end : slowly();
  }

  std::array<char, 17> text;
  shortest::put_digits(text.data(), digits);
  std::size_t first = 0, last = text.size();
  while (text[first] == '0') ++first;
  const int whole = static_cast<int>(last - first) + decimal.exponent;  // digits before the point
  while (text[last - 1] == '0') --last;
  const auto count = static_cast<int>(last - first);
  if (count <= whole) return slowly();  // no point at all
  if (negative) *to++ = '-';
  const int fixed_length = whole > 0 ? count + 1 : count + 2 - whole;
  const int scientific_length = count + (count > 1 ? 5 : 4);
  return fixed_length > scientific_length ? shortest::put_scientific(to, text.data() + first, count, 1 - whole)
                                          : shortest::put_fixed(to, text.data() + first, count, whole);
}

}  // namespace alcap::detail
