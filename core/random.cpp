#include "core/random.h"

#include <Random123/philox.h>

#include <cmath>

#include "core/hash.h"

namespace locsim {

namespace {

// 53 random bits, centred in their cell: (0, 1).
double uniform_from_two(std::uint32_t high, std::uint32_t low) {
  const std::uint64_t mantissa = ((static_cast<std::uint64_t>(high) << 32) | low) >> 12;
  return (static_cast<double>(mantissa) + 0.5) * 0x1p-52;
}

template <std::size_t N>
double polynomial(const std::array<double, N>& coefficients, double x) {
  double value = coefficients[N - 1];
  for (std::size_t i = N - 1; i-- > 0;) value = value * x + coefficients[i];
  return value;
}

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::string_view purpose) {
  Hash hash;
  hash.add(seed);
  hash.add_bytes(purpose.data(), purpose.size());
  const std::uint64_t key = hash.value();
  key_ = {static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)};
}

std::array<std::uint32_t, 4> RandomStream::bits(std::uint64_t index, std::uint64_t lane) const {
  using Philox = r123::Philox4x32;
  const Philox::ctr_type counter = {
      {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32),
       static_cast<std::uint32_t>(lane), static_cast<std::uint32_t>(lane >> 32)}};
  const Philox::key_type key = {{key_[0], key_[1]}};
  const Philox::ctr_type out = Philox{}(counter, key);
  return {out[0], out[1], out[2], out[3]};
}

double RandomStream::uniform(std::uint64_t index, std::uint64_t lane) const {
  const auto b = bits(index, lane);
  return uniform_from_two(b[0], b[1]);
}

double RandomStream::uniform(double low, double high, std::uint64_t index,
                             std::uint64_t lane) const {
  return low + (high - low) * uniform(index, lane);
}

double RandomStream::gaussian(std::uint64_t index, std::uint64_t lane) const {
  return inverse_normal_cdf(uniform(index, lane));
}

Vector3d RandomStream::gaussian3(std::uint64_t index, std::uint64_t lane) const {
  const auto b = bits(index, lane);
  return {inverse_normal_cdf(uniform_from_bits(b[0])), inverse_normal_cdf(uniform_from_bits(b[1])),
          inverse_normal_cdf(uniform_from_bits(b[2]))};
}

std::size_t RandomSequence::pick(std::size_t count) {
  const auto i = static_cast<std::size_t>(uniform() * static_cast<double>(count));
  return i < count ? i : count - 1;
}

double inverse_normal_cdf(double probability) {
  constexpr std::array<double, 8> a = {3.3871328727963666080e0,  1.3314166789178437745e+2,
                                       1.9715909503065514427e+3, 1.3731693765509461125e+4,
                                       4.5921953931549871457e+4, 6.7265770927008700853e+4,
                                       3.3430575583588128105e+4, 2.5090809287301226727e+3};
  constexpr std::array<double, 8> b = {1.0,
                                       4.2313330701600911252e+1,
                                       6.8718700749205790830e+2,
                                       5.3941960214247511077e+3,
                                       2.1213794301586595867e+4,
                                       3.9307895800092710610e+4,
                                       2.8729085735721942674e+4,
                                       5.2264952788528545610e+3};
  constexpr std::array<double, 8> c = {1.42343711074968357734e0,  4.63033784615654529590e0,
                                       5.76949722146069140550e0,  3.64784832476320460504e0,
                                       1.27045825245236838258e0,  2.41780725177450611770e-1,
                                       2.27238449892691845833e-2, 7.74545014278341407640e-4};
  constexpr std::array<double, 8> d = {1.0,
                                       2.05319162663775882187e0,
                                       1.67638483018380384940e0,
                                       6.89767334985100004550e-1,
                                       1.48103976427480074590e-1,
                                       1.51986665636164571966e-2,
                                       5.47593808499534494600e-4,
                                       1.05075007164441684324e-9};
  constexpr std::array<double, 8> e = {6.65790464350110377720e0,  5.46378491116411436990e0,
                                       1.78482653991729133580e0,  2.96560571828504891230e-1,
                                       2.65321895265761230930e-2, 1.24266094738807843860e-3,
                                       2.71155556874348757815e-5, 2.01033439929228813265e-7};
  constexpr std::array<double, 8> f = {1.0,
                                       5.99832206555887937690e-1,
                                       1.36929880922735805310e-1,
                                       1.48753612908506148525e-2,
                                       7.86869131145613259100e-4,
                                       1.84631831751005468180e-5,
                                       1.42151175831644588870e-7,
                                       2.04426310338993978564e-15};

  const double q = probability - 0.5;
  if (std::abs(q) <= 0.425) {
    const double r = 0.180625 - q * q;
    return q * polynomial(a, r) / polynomial(b, r);
  }
  const double tail = q < 0.0 ? probability : 1.0 - probability;
  const double r = std::sqrt(-std::log(tail));
  const double x = r <= 5.0 ? polynomial(c, r - 1.6) / polynomial(d, r - 1.6)
                            : polynomial(e, r - 5.0) / polynomial(f, r - 5.0);
  return q < 0.0 ? -x : x;
}

float gaussian_from_bits(std::uint32_t bits) {
  constexpr std::uint32_t kCellBits = 11;
  constexpr std::uint32_t kCells = 1U << kCellBits;
  constexpr std::uint32_t kTail = 32;  // cells left to the exact quantile on each side
  constexpr std::uint32_t kRestBits = 32 - kCellBits;
  static const std::array<float, kCells + 1> table = [] {
    std::array<float, kCells + 1> values{};
    for (std::uint32_t i = kTail; i <= kCells - kTail; ++i) {
      values[i] = static_cast<float>(inverse_normal_cdf(static_cast<double>(i) / kCells));
    }
    return values;
  }();
  const std::uint32_t cell = bits >> kRestBits;
  if (cell < kTail || cell >= kCells - kTail) {
    return static_cast<float>(inverse_normal_cdf(uniform_from_bits(bits)));
  }
  constexpr std::uint32_t kRestMask = (1U << kRestBits) - 1;
  const float within =
      (static_cast<float>(bits & kRestMask) + 0.5F) / static_cast<float>(1U << kRestBits);
  return table[cell] + within * (table[cell + 1] - table[cell]);
}

}  // namespace locsim
