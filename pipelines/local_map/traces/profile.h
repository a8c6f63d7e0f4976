// A similarity over a range of positions: where its peak is, and how sharply it is determined.
#pragma once

#include <array>
#include <cstddef>

namespace cairn::local_map {

struct Peak {
  double at_m = 0;  // sub-step
  double value = 0;
  double sd_m = 0;  // of what exp(sharpness * profile) says, about the peak; infinite where that is as broad
                    // as the range, so that nothing is determined
  bool inside = true;  // false: at an end of the range
};

// Values at steps of `step_m` from -reach * step_m to reach * step_m. Of fixed size: no allocation.
class Profile {
 public:
  static constexpr int kReach = 96;

  // Holds `reach_m` on both sides, cut to kReach steps.
  Profile(double step_m, double reach_m);

  double step_m() const { return step_m_; }
  int reach() const { return reach_; }
  double& operator[](int step) { return value_[static_cast<std::size_t>(step + kReach)]; }
  double operator[](int step) const { return value_[static_cast<std::size_t>(step + kReach)]; }
  double At(double at_m) const;  // linear between steps, clamped to the ends

  // `sharpness`: nats for one unit of the profile.
  Peak FindPeak(double sharpness) const;

 private:
  double step_m_;
  int reach_;
  std::array<double, 2 * kReach + 1> value_{};
};

// The vertex of the parabola through three values at -1, 0, 1 of which the middle one is the largest: in
// [-1/2, 1/2].
double Vertex(double before, double middle, double after);

}  // namespace cairn::local_map
