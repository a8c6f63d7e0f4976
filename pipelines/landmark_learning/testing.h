// Samples of a corridor for tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/rng.h"

namespace cairn::landmark_learning {

// Runs along a straight corridor, a sample each half metre or so. Three of the inputs are bumps ("doors") at
// positions that repeat irregularly, seen through noise; one is noise alone, one never changes.
struct CorridorSamples {
  int runs = 3, samples = 80;
  double length_m = 40.0, noise = 0.1;
  std::uint64_t seed = 1;
  // Headings are known; every other run comes back from the far end and sees the other side of things.
  bool both_ways = false;

  Blob Make() const {
    Rng rng(seed);
    Blob blob;
    std::vector<std::string> names;
    for (int r = 0; r < runs; ++r) {
      names.push_back("run " + std::to_string(r));
      Add("run/" + std::to_string(r) + "/", both_ways && r % 2 == 1, rng, &blob);
    }
    blob.Put("runs", Array::Texts(names));
    blob.Put("input_name", Array::Texts({"door", "light", "bin", "noise", "constant"}));
    return blob;
  }

 private:
  void Add(const std::string& prefix, bool back, Rng& rng, Blob* blob) const {
    std::vector<double> time, x, y, heading;
    std::vector<float> input;
    for (int k = 0; k < samples; ++k) {
      time.push_back(k);
      x.push_back(length_m * (k + 0.3 * rng.Uniform()) / samples);
      y.push_back(0.05 * rng.Normal());
      const double at = back ? 1.7 * length_m - x.back() : x.back();
      if (back) x.back() = length_m - x.back();
      heading.push_back((back ? 3.1 : 0.0) + 0.1 * std::sin(k));
      const double bumps[] = {std::sin(1.3 * at) + std::sin(0.41 * at), std::cos(0.9 * at),
                              std::sin(0.23 * at + 1.0)};
      for (const double bump : bumps) input.push_back(static_cast<float>(bump + noise * rng.Normal()));
      input.push_back(static_cast<float>(rng.Normal()));
      input.push_back(7.0F);
    }
    blob->PutVector(prefix + "time_s", time);
    blob->PutVector(prefix + "x_m", x);
    blob->PutVector(prefix + "y_m", y);
    if (both_ways) blob->PutVector(prefix + "heading_rad", heading);
    blob->Put(prefix + "input", Array::Of<float>({samples, 5}, input));
  }
};

}  // namespace cairn::landmark_learning
