// A counter-based random number generator with distributions of our own: the same numbers everywhere.
// Philox4x32-10 of J. K. Salmon et al., Parallel random numbers: as easy as 1, 2, 3, SC 2011.
#pragma once

#include <array>
#include <cstdint>

namespace cairn {

class Rng {
 public:
  // Streams of different (seed, stream, substream) are independent: (job seed, round, task), say.
  explicit Rng(std::uint64_t seed, std::uint64_t stream = 0, std::uint32_t substream = 0);

  std::uint32_t Bits32();
  std::uint64_t Bits64();
  double Uniform();  // in [0, 1), 53 bits
  double Uniform(double low, double high);
  std::uint64_t Below(std::uint64_t n);  // in [0, n), without bias; n >= 1
  double Normal();                       // mean 0, variance 1 (Box-Muller)

 private:
  void Refill();
  std::array<std::uint32_t, 2> key_;
  std::array<std::uint32_t, 4> counter_;
  std::array<std::uint32_t, 4> block_{};
  int left_ = 0;
  double spare_ = 0;
  bool has_spare_ = false;
};

// One block of Philox4x32-10, as the reference tests give it.
std::array<std::uint32_t, 4> Philox4x32(std::array<std::uint32_t, 4> counter,
                                        std::array<std::uint32_t, 2> key);

}  // namespace cairn
