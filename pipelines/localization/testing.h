// A corridor with hand-made features, for tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "schema/blob.h"
#include "schema/rng.h"

namespace cairn::localization {

// Runs along a straight corridor, a sample each 0.2 m or so. Each feature is a probability that is high in
// half of the corridor, in pieces that get shorter from the first to the last: together they name a position,
// as the bits of a number do.
struct CorridorWithFeatures {
  int runs = 3;
  double length_m = 60.0;
  double error = 0.1;  // how far a feature is from 0 or 1
  std::uint64_t seed = 1;
  // Headings are known; every other run comes back from the far end, where all features are turned round.
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
    blob.Put("input_name", Array::Texts({"nothing"}));
    blob.Put("feature_name", Array::Texts({"half", "quarter", "stripe"}));
    return blob;
  }

 private:
  void Add(const std::string& prefix, bool back, Rng& rng, Blob* blob) const {
    std::vector<double> time, x, y, heading;
    std::vector<float> feature;
    for (double at_m = 0.0; at_m < length_m; at_m += rng.Uniform(0.15, 0.25)) {
      time.push_back(static_cast<double>(time.size()));
      const double x_m = back ? length_m - at_m : at_m;
      x.push_back(x_m);
      heading.push_back(std::remainder((back ? 3.14 : 0.0) + 0.1 * std::sin(at_m), 2 * 3.14159265358979));
      y.push_back(0.05 * rng.Normal());
      for (const double period_m : {length_m, 0.45 * length_m, 0.17 * length_m}) {
        const bool high = (std::fmod(x_m, period_m) > 0.5 * period_m) != back;
        feature.push_back(static_cast<float>(high ? 1.0 - error : error));
      }
    }
    const auto samples = static_cast<std::int64_t>(time.size());
    blob->PutVector(prefix + "time_s", time);
    blob->PutVector(prefix + "x_m", x);
    blob->PutVector(prefix + "y_m", y);
    if (both_ways) blob->PutVector(prefix + "heading_rad", heading);
    blob->Put(prefix + "input", Array::Of<float>({samples, 1}, std::vector<float>(time.size(), 0.0F)));
    blob->Put(prefix + "feature", Array::Of<float>({samples, 3}, feature));
  }
};

}  // namespace cairn::localization
