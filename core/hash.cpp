#include "core/hash.h"

namespace locsim {

std::string Hash::hex() const {
  constexpr char digits[] = "0123456789abcdef";
  std::string text(16, '0');
  std::uint64_t x = value();
  for (std::size_t i = 16; i-- > 0; x >>= 4) text[i] = digits[x & 15];
  return text;
}

}  // namespace locsim
