// Tables of errors of matching.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "pipelines/local_map/traces/find_on.h"

namespace cairn::local_map {

inline double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

struct Errors {
  std::vector<double> z, u, norm_z, norm_u;
  int tried = 0, used = 0, wrong = 0, no_z = 0, no_u = 0;

  void Print(const char* name) const {
    std::printf(
        "%-34s tried %5d used %4.1f%% no z %4.1f%% | z m: median %.3f 90%% %.3f, in sd: 68%% %.2f 95%% %.2f "
        "| u m: "
        "median %.3f 90%% %.3f, in sd: 68%% %.2f 95%% %.2f | off by more than 0.3 m: %.2f%%\n",
        name, tried, 100.0 * used / tried, 100.0 * no_z / std::max(used, 1), Quantile(z, 0.5),
        Quantile(z, 0.9), Quantile(norm_z, 0.68), Quantile(norm_z, 0.95), Quantile(u, 0.5), Quantile(u, 0.9),
        Quantile(norm_u, 0.68), Quantile(norm_u, 0.95), 100.0 * wrong / std::max(used, 1));
  }
  void Add(const Position& truth, double z_m, double u_m, double sd_z_m, double sd_u_m) {
    ++used;
    bool far = false;
    const auto one = [&](double error, double sd, std::vector<double>& errors, std::vector<double>& norms,
                         int& none) {
      if (std::isinf(sd)) {
        ++none;
        return;
      }
      errors.push_back(error);
      norms.push_back(error / sd);
      far = far || error > 0.3;
    };
    one(std::abs(z_m - truth.z_m), sd_z_m, z, norm_z, no_z);
    one(std::abs(u_m - truth.u_m), sd_u_m, u, norm_u, no_u);
    wrong += far ? 1 : 0;
  }
};

struct Loops {
  Errors errors;
  std::vector<double> confidence_right, confidence_wrong;

  void Add(const std::vector<Candidate>& found, const Position* truth) {
    ++errors.tried;
    if (found.empty()) return;
    const Candidate& best = found[0];
    const bool right =
        truth && std::abs(best.z_m - truth->z_m) < 0.5 && std::abs(best.u_m - truth->u_m) < 0.4;
    (right ? confidence_right : confidence_wrong).push_back(best.confidence);
    if (right) errors.Add(*truth, best.z_m, best.u_m, best.sd_z_m, best.sd_u_m);
  }
  void Print(const char* name) const {
    errors.Print(name);
    for (const double level : {0.5, 0.7, 0.9, 0.99})
      std::printf("    confidence over %.3f: right %ld, wrong %ld\n", level,
                  std::count_if(confidence_right.begin(), confidence_right.end(),
                                [&](double c) { return c > level; }),
                  std::count_if(confidence_wrong.begin(), confidence_wrong.end(),
                                [&](double c) { return c > level; }));
  }
};

}  // namespace cairn::local_map
