#include "pipelines/landmark_map/landmarks/summary.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "pipelines/common/handed_over.h"
#include "pipelines/common/taps.h"

namespace cairn::landmark_map {
namespace {

double WrapAngle(double angle) {
  return angle - 2.0 * std::numbers::pi * std::ceil((angle - std::numbers::pi) / (2.0 * std::numbers::pi));
}

// Calls f(layer, x, y, mass) for every cell with mass, in a fixed order.
template <class F>
void ForEach(const LayeredGrid& belief, const F& f) {
  for (std::size_t c = 0; c < belief.layers.size(); ++c) {
    const Layer& layer = belief.layers[c];
    for (int y = layer.box.y0; y < layer.box.y0 + layer.box.ny; ++y) {
      for (int x = layer.box.x0; x < layer.box.x0 + layer.box.nx; ++x) {
        if (const double mass = layer.Row(y)[x]; mass > 0.0) f(static_cast<int>(c), x, y, mass);
      }
    }
  }
}

void FindMode(const LayeredGrid& belief, const GridSpec& grid, PoseSummary* pose) {
  double best = -1.0;
  int mode_c = 0, mode_x = 0, mode_y = 0;
  ForEach(belief, [&](int c, int x, int y, double mass) {
    if (mass <= best) return;
    best = mass;
    mode_c = c;
    mode_x = x;
    mode_y = y;
  });
  double sum = 0, dx = 0, dy = 0, dc = 0;
  for (int k = -1; k <= 1; ++k) {
    const Layer& layer =
        belief.layers[static_cast<std::size_t>((mode_c + k + grid.headings) % grid.headings)];
    for (int y = mode_y - 1; y <= mode_y + 1; ++y) {
      for (int x = mode_x - 1; x <= mode_x + 1; ++x) {
        const double mass = layer.At(x, y);
        sum += mass;
        dx += mass * (x - mode_x);
        dy += mass * (y - mode_y);
        dc += mass * k;
      }
    }
  }
  const double step = 2.0 * std::numbers::pi / grid.headings;
  pose->mode_x_m = (mode_x + dx / sum) * grid.cell_m;
  pose->mode_y_m = (mode_y + dy / sum) * grid.cell_m;
  pose->mode_heading_rad = WrapAngle((mode_c + dc / sum) * step);
}

struct Moments {
  double mass = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  void Add(double px, double py, double m) {
    mass += m;
    x += m * px;
    y += m * py;
    xx += m * px * px;
    xy += m * px * py;
    yy += m * py * py;
  }
};

Moments MomentsWithin(const Layer& layer, double cx, double cy, double radius) {
  Moments moments;
  const int reach = static_cast<int>(std::ceil(radius));
  const int mx = static_cast<int>(std::lround(cx)), my = static_cast<int>(std::lround(cy));
  const Box box = Intersection(layer.box, Box{mx, my, 1, 1}.Grown(reach));
  for (int y = box.y0; y < box.y0 + box.ny; ++y) {
    for (int x = box.x0; x < box.x0 + box.nx; ++x) {
      const double dx = x - cx, dy = y - cy;
      if (dx * dx + dy * dy <= radius * radius) moments.Add(x, y, layer.Row(y)[x]);
    }
  }
  return moments;
}

Landmark FromMoments(const Moments& m, int type, double cell_m) {
  const double x = m.x / m.mass, y = m.y / m.mass, area = cell_m * cell_m;
  const double floor = 1.0 / 12.0;  // a cell is not a point
  const double xy = (m.xy / m.mass - x * y) * area;
  return {x * cell_m,
          y * cell_m,
          {(m.xx / m.mass - x * x + floor) * area, xy, xy, (m.yy / m.mass - y * y + floor) * area},
          type,
          m.mass};
}

// Expected counts, their blur, and what is left of both as landmarks are taken out of them.
class PeakFinder {
 public:
  // `radius`, in cells: what lies within it of a landmark is that landmark's.
  PeakFinder(Layer counts, double radius) : counts_(std::move(counts)), radius_(radius) {
    smooth_ = Blur(counts_, Sigma());
    left_.resize(static_cast<std::size_t>(counts_.box.ny));
    highest_.resize(static_cast<std::size_t>(smooth_.box.ny));
    Look(counts_.box, smooth_.box);
  }

  double Left() const { return std::accumulate(left_.begin(), left_.end(), 0.0); }

  // The landmark around the strongest peak, its window moved to its own mean until it stays. False: none is
  // left.
  bool Take(int type, double cell_m, Landmark* landmark) {
    const auto row = std::ranges::max_element(highest_, {}, &Peak::height);
    if (row == highest_.end() || row->height <= 0.0) return false;
    double cx = row->x, cy = smooth_.box.y0 + static_cast<double>(row - highest_.begin());
    Moments moments;
    for (int i = 0; i < 10; ++i) {
      moments = MomentsWithin(counts_, cx, cy, radius_);
      if (!(moments.mass > 0.0)) return false;
      cx = moments.x / moments.mass;
      cy = moments.y / moments.mass;
    }
    *landmark = FromMoments(moments, type, cell_m);
    Remove(cx, cy);
    return true;
  }

 private:
  double Sigma() const { return 0.5 * radius_; }

  // Takes the disc out of the counts and blurs again where that is seen: the rest of the blur stays as it is.
  void Remove(double cx, double cy) {
    const int reach = static_cast<int>(std::ceil(radius_)) + 1;
    const Box centre{static_cast<int>(std::lround(cx)), static_cast<int>(std::lround(cy)), 1, 1};
    const Box disc = Intersection(counts_.box, centre.Grown(reach));
    for (int y = disc.y0; y < disc.y0 + disc.ny; ++y) {
      for (int x = disc.x0; x < disc.x0 + disc.nx; ++x) {
        const double dx = x - cx, dy = y - cy;
        if (dx * dx + dy * dy <= radius_ * radius_) counts_.Row(y)[x] = 0.0;
      }
    }
    const int blur = GaussianTaps(Sigma()).reach();
    const Box seen = Intersection(smooth_.box, disc.Grown(blur));
    Layer part(Intersection(counts_.box, seen.Grown(blur)));
    Copy(counts_, part.box, &part);
    Copy(Blur(part, Sigma()), seen, &smooth_);
    Look(disc, seen);
  }

  // Looks again at the rows of two boxes: what is left in them, where they are highest.
  void Look(const Box& counted, const Box& smoothed) {
    for (int y = counted.y0; y < counted.y0 + counted.ny; ++y) {
      const double* row = &std::as_const(counts_).Row(y)[counts_.box.x0];
      left_[static_cast<std::size_t>(y - counts_.box.y0)] = std::accumulate(row, row + counts_.box.nx, 0.0);
    }
    for (int y = smoothed.y0; y < smoothed.y0 + smoothed.ny; ++y) {
      const double* row = &std::as_const(smooth_).Row(y)[smooth_.box.x0];
      const double* peak = std::max_element(row, row + smooth_.box.nx);
      highest_[static_cast<std::size_t>(y - smooth_.box.y0)] = {
          *peak, smooth_.box.x0 + static_cast<int>(peak - row)};
    }
  }

  static void Copy(const Layer& from, const Box& box, Layer* to) {
    for (int y = box.y0; y < box.y0 + box.ny; ++y) {
      for (int x = box.x0; x < box.x0 + box.nx; ++x) to->Row(y)[x] = from.Row(y)[x];
    }
  }

  struct Peak {
    double height;
    int x;
  };

  Layer counts_, smooth_;
  double radius_;
  std::vector<double> left_;   // per row of counts_
  std::vector<Peak> highest_;  // per row of smooth_
};

}  // namespace

PoseSummary Summarise(const LayeredGrid& belief, const GridSpec& grid) {
  const double step = 2.0 * std::numbers::pi / grid.headings;
  double mass = 0, x = 0, y = 0, cosine = 0, sine = 0;
  ForEach(belief, [&](int /*layer*/, int i, int j, double m) {
    mass += m;
    x += m * i;
    y += m * j;
  });
  for (std::size_t c = 0; c < belief.layers.size(); ++c) {
    const double m = belief.layers[c].Sum();
    cosine += m * std::cos(c * step);
    sine += m * std::sin(c * step);
  }
  PoseSummary pose{};
  x /= mass;
  y /= mass;
  pose.x_m = x * grid.cell_m;
  pose.y_m = y * grid.cell_m;
  pose.heading_rad = std::atan2(sine, cosine);
  double* v = pose.covariance;
  ForEach(belief, [&](int c, int i, int j, double m) {
    const double d[3] = {(i - x) * grid.cell_m, (j - y) * grid.cell_m,
                         WrapAngle(c * step - pose.heading_rad)};
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) v[3 * a + b] += m / mass * d[a] * d[b];
    }
  });
  FindMode(belief, grid, &pose);
  return pose;
}

// Of every step of every round, so it adds up in lanes, which run side by side.
Point MeanPosition(const LayeredGrid& belief, const GridSpec& grid) {
  constexpr int kLanes = 4;
  double mass = 0, x = 0, y = 0;
  for (const Layer& layer : belief.layers) {
    const int end = layer.box.x0 + layer.box.nx;
    for (int j = layer.box.y0; j < layer.box.y0 + layer.box.ny; ++j) {
      const auto row = layer.Row(j);
      double sum[kLanes] = {}, along[kLanes] = {};
      int i = layer.box.x0;
      for (; i + kLanes <= end; i += kLanes) {
        for (int k = 0; k < kLanes; ++k) {
          sum[k] += row[i + k];
          along[k] += row[i + k] * (i + k);
        }
      }
      for (; i < end; ++i) {
        sum[0] += row[i];
        along[0] += row[i] * i;
      }
      const double of_row = (sum[0] + sum[1]) + (sum[2] + sum[3]);
      mass += of_row;
      x += (along[0] + along[1]) + (along[2] + along[3]);
      y += of_row * j;
    }
  }
  return {x / mass * grid.cell_m, y / mass * grid.cell_m};
}

namespace {

// The class that the observations within `radius` cells speak for.
int MostLikelyClass(const Landmark& landmark, const LayeredGrid& counts, double radius,
                    const MapRules& rules) {
  if (rules.classes.count == 1) return 0;
  const double cell = rules.grid.cell_m;
  std::vector<double> seemed;
  for (int k = 0; k < rules.classes.count; ++k) {
    const Layer& layer = counts.layers[static_cast<std::size_t>(rules.types + k)];
    seemed.push_back(MomentsWithin(layer, landmark.x_m / cell, landmark.y_m / cell, radius).mass);
  }
  const std::vector<double> posterior = ClassPosterior(seemed, rules.classes);
  return static_cast<int>(std::ranges::max_element(posterior) - posterior.begin());
}

// Takes what lies within core_m of the landmark out of a layer, and returns how much that is.
double TakeDisc(const Landmark& landmark, const MapRules& rules, Layer* layer) {
  const double x0 = landmark.x_m / rules.grid.cell_m, y0 = landmark.y_m / rules.grid.cell_m;
  const double radius = rules.core_m / rules.grid.cell_m;
  double taken = 0.0;
  const Box centre{static_cast<int>(std::lround(x0)), static_cast<int>(std::lround(y0)), 1, 1};
  const Box disc = Intersection(layer->box, centre.Grown(static_cast<int>(std::ceil(radius)) + 1));
  for (int y = disc.y0; y < disc.y0 + disc.ny; ++y) {
    for (int x = disc.x0; x < disc.x0 + disc.nx; ++x) {
      if (std::hypot(x - x0, y - y0) > radius) continue;
      taken += layer->Row(y)[x];
      layer->Row(y)[x] = 0.0;
    }
  }
  return taken;
}

// Of what was observed of a landmark that has a name.
double NamedRadius(const MapRules& rules) {
  return std::max(5.0 * rules.observation_m, 2.0 * rules.grid.cell_m);
}

// One that was hardly ever seen, so near to a landmark that has a name that it was most likely that one,
// which is then given what it counts.
bool IsOfNamed(const Landmark& landmark, const MapRules& rules, std::vector<Landmark>* landmarks) {
  constexpr double kSeldom = 2.0;
  if (landmark.count >= kSeldom) return false;
  for (Landmark& named : *landmarks) {
    if (named.type >= rules.types) break;
    if (std::hypot(named.x_m - landmark.x_m, named.y_m - landmark.y_m) > NamedRadius(rules)) continue;
    named.count += landmark.count;
    return true;
  }
  return false;
}

}  // namespace

std::vector<Landmark> LandmarksIn(const Blob& blob, const MapRules& rules) {
  constexpr double kMostCount = 1e15;
  std::vector<Landmark> landmarks = RowsIn<Landmark>(blob);
  for (const Landmark& landmark : landmarks) {
    RequireWithin("a landmark's x_m", landmark.x_m, -kFar_m, kFar_m);
    RequireWithin("a landmark's y_m", landmark.y_m, -kFar_m, kFar_m);
    RequireWithin("a landmark's type", std::int64_t{landmark.type}, 0, rules.types);
    RequireWithin("a landmark's class", std::int64_t{landmark.landmark_class}, 0, rules.classes.count - 1);
    RequireWithin("a landmark's count", landmark.count, 0.0, kMostCount);
    RequireAllWithin("a landmark's covariance", landmark.covariance_m2, -kFar_m * kFar_m, kFar_m * kFar_m);
  }
  return landmarks;
}

std::vector<Landmark> ExtractLandmarks(const LayeredGrid& counts, const MapRules& rules) {
  constexpr double kLeastCount = 0.5;
  const double cell = rules.grid.cell_m;
  std::vector<Landmark> landmarks;
  for (int type = 0; type <= rules.types; ++type) {
    const bool identified = type < rules.types;
    Layer count = identified ? counts.layers[static_cast<std::size_t>(type)]
                             : CountsOfAllClasses(counts, type, rules.classes);
    if (!identified && rules.partly_named) {
      for (Landmark& named : landmarks) named.count += TakeDisc(named, rules, &count);
    }
    const double radius = (identified ? NamedRadius(rules) : rules.core_m) / cell;
    PeakFinder peaks(count, radius);
    while (peaks.Left() >= kLeastCount) {
      Landmark landmark;
      if (!peaks.Take(type, cell, &landmark)) break;
      if (landmark.count < kLeastCount) continue;  // peaks come by height, not by count
      if (!identified && rules.partly_named && IsOfNamed(landmark, rules, &landmarks)) continue;
      if (!identified) landmark.landmark_class = MostLikelyClass(landmark, counts, radius, rules);
      landmarks.push_back(landmark);
      if (identified) break;
    }
  }
  return landmarks;
}

std::vector<double> LeaveOut(const Landmark& landmark, const MapRules& rules, LayeredGrid* counts) {
  std::vector<double> taken(counts->layers.size(), 0.0);
  const bool identified = landmark.type < rules.types;
  const int first = identified ? landmark.type : rules.types;
  const int end = identified ? landmark.type + 1 : rules.layers();
  for (int l = 0; l < rules.layers(); ++l) {
    const bool may_be = (l >= first && l < end) || (rules.partly_named && l >= rules.types);
    const auto at = static_cast<std::size_t>(l);
    if (may_be) taken[at] = TakeDisc(landmark, rules, &counts->layers[at]);
  }
  return taken;
}

Association Associate(const Layer& where, int type, const std::vector<Landmark>& landmarks, double cell_m,
                      double reach_m) {
  std::vector<double> mass(landmarks.size() + 1, 0.0);  // the last: none of them
  for (int y = where.box.y0; y < where.box.y0 + where.box.ny; ++y) {
    for (int x = where.box.x0; x < where.box.x0 + where.box.nx; ++x) {
      double nearest = reach_m * reach_m;
      std::size_t winner = landmarks.size();
      for (std::size_t k = 0; k < landmarks.size(); ++k) {
        if (type != kOfAnyType && landmarks[k].type != type) continue;
        const double dx = x * cell_m - landmarks[k].x_m, dy = y * cell_m - landmarks[k].y_m;
        if (dx * dx + dy * dy >= nearest) continue;
        nearest = dx * dx + dy * dy;
        winner = k;
      }
      mass[winner] += where.Row(y)[x];
    }
  }
  const auto best = std::ranges::max_element(mass) - mass.begin();
  // What is rounded up in all the cells' sum would make a certain one surer than certain.
  const double all = std::max(1.0, std::accumulate(mass.begin(), mass.end(), 0.0));
  const double probability = mass[static_cast<std::size_t>(best)] / all;
  return {static_cast<std::size_t>(best) == landmarks.size() ? -1 : static_cast<int>(best), probability};
}

}  // namespace cairn::landmark_map
