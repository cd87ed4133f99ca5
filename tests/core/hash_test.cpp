#include "core/hash.h"

#include <gtest/gtest.h>

#include <bit>
#include <set>
#include <string>
#include <vector>

namespace locsim {
namespace {

template <typename... Values>
std::uint64_t hash_of(Values... values) {
  Hash hash;
  (hash.add(values), ...);
  return hash.value();
}

TEST(Hash, DependsOnEveryValueAndTheirOrder) {
  EXPECT_EQ(hash_of(1.0, 2.0), hash_of(1.0, 2.0));
  EXPECT_NE(hash_of(1.0, 2.0), hash_of(2.0, 1.0));
  EXPECT_NE(hash_of(1.0), hash_of(1.0, 0.0));
  EXPECT_NE(hash_of(), hash_of(0.0));
  EXPECT_NE(hash_of(1.0), hash_of(1.0 + 0x1p-52));
  EXPECT_EQ(hash_of(0.0), hash_of(-0.0));
}

TEST(Hash, BytesOfAnyLengthCount) {
  const auto of = [](const std::string& text) {
    Hash hash;
    hash.add_bytes(text.data(), text.size());
    return hash.value();
  };
  std::set<std::uint64_t> seen;
  std::string text;
  for (int i = 0; i < 40; ++i) {
    seen.insert(of(text));
    seen.insert(of(text + "x"));
    text += '\0';
  }
  EXPECT_EQ(seen.size(), 80U);
}

TEST(Hash, OneBitTurnsAboutHalfOfThem) {
  double flipped = 0.0;
  for (int bit = 0; bit < 64; ++bit) {
    flipped += std::popcount(hash_of(std::uint64_t{12345}) ^
                             hash_of(std::uint64_t{12345} ^ (std::uint64_t{1} << bit)));
  }
  // 64·64 coin tosses: 32 ± 0.5 on average; 5 sigma.
  EXPECT_NEAR(flipped / 64.0, 32.0, 2.5);
}

TEST(Hash, HasNoCollisionsAmongManyCounters) {
  std::set<std::uint64_t> seen;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    for (std::uint64_t j = 0; j < 200; ++j) seen.insert(hash_of(i, j));
  }
  // Expected collisions of 2e5 64-bit values: 1e-9.
  EXPECT_EQ(seen.size(), 200'000U);
}

TEST(Hash, HexIsTheValueInSixteenDigits) {
  Hash hash;
  hash.add(std::uint64_t{7});
  EXPECT_EQ(hash.hex().size(), 16U);
  EXPECT_EQ(std::stoull(hash.hex(), nullptr, 16), hash.value());
}

}  // namespace
}  // namespace locsim
