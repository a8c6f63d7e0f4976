#include "pipelines/landmark_map/landmarks/image_landmarks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <tuple>

namespace cairn::landmark_map {
namespace {

constexpr double kGate = 3.0;  // standard deviations
constexpr int kPasses = 12;
constexpr double kLeastCount = 2.0;
constexpr double kLeastRate = 0.1;  // seen in so many of the images that looked there
constexpr double kTogether = 0.1;   // of its images show the other too: they are two
constexpr double kNeeded = 0.02;    // of its range-bearing observations no other landmark could have
constexpr std::int32_t kNoLandmark = -1;

double Distance(const Point& a, const Point& b) { return std::hypot(a.x_m - b.x_m, a.y_m - b.y_m); }

// What the sensor sees, as the log shows it: nine range-bearing observations of ten are nearer and further
// ahead.
struct FieldOfView {
  double range_m = 0.0, half_rad = 0.0;

  explicit FieldOfView(const std::vector<ImageObservations>& images) {
    std::vector<double> ranges, angles;
    for (const ImageObservations& image : images) {
      for (const Point& position : image.seen) {
        ranges.push_back(Distance(image.from, position));
        angles.push_back(std::abs(Angle(image, position)));
      }
    }
    range_m = NineTenths(&ranges);
    half_rad = NineTenths(&angles);
  }
  bool Holds(const ImageObservations& image, const Point& position) const {
    return Distance(image.from, position) <= range_m && std::abs(Angle(image, position)) <= half_rad;
  }

 private:
  static double Angle(const ImageObservations& image, const Point& position) {
    return std::remainder(
        std::atan2(position.y_m - image.from.y_m, position.x_m - image.from.x_m) - image.heading_rad,
        2.0 * std::numbers::pi);
  }
  static double NineTenths(std::vector<double>* values) {
    if (values->empty()) return 0.0;
    const auto at = static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(values->size() - 1));
    std::ranges::nth_element(*values, values->begin() + at);
    return (*values)[static_cast<std::size_t>(at)];
  }
};

class ImageClusters {
 public:
  ImageClusters(const std::vector<ImageObservations>& images, const ImageRules& rules)
      : images_(images), rules_(rules), gate_m_(kGate * rules.sigma_m), view_(images) {
    for (const ImageObservations& image : images) given_.emplace_back(image.seen.size(), kNoLandmark);
    shift_.resize(images.size());
  }

  void Pass(bool births) {
    for (std::size_t i = 0; i < images_.size(); ++i) {
      Give(i);
      if (births) Begin(i);
    }
    Move();
  }
  void MergeDoubles();
  void DropNeedless();
  void DropWeak();
  ImageLandmarks Result() const;

 private:
  // The shift that image i's pairs ask for, as the mean of n errors and a pose's own says: n / (n + 1).
  void Give(std::size_t i) {
    shift_[i] = {};
    for (int k = 0; k < 3; ++k) {
      Pair(i);
      Point sum{};
      double n = 0;
      for (std::size_t s = 0; s < given_[i].size(); ++s) {
        if (given_[i][s] == kNoLandmark) continue;
        const Point& to = positions_[static_cast<std::size_t>(given_[i][s])];
        sum.x_m += to.x_m - images_[i].seen[s].x_m;
        sum.y_m += to.y_m - images_[i].seen[s].y_m;
        ++n;
      }
      shift_[i] = {sum.x_m / (n + 1), sum.y_m / (n + 1)};
    }
  }

  Point Seen(std::size_t i, std::size_t s) const {
    return {images_[i].seen[s].x_m + shift_[i].x_m, images_[i].seen[s].y_m + shift_[i].y_m};
  }

  // Nearest pairs first, each range-bearing observation and each landmark once.
  void Pair(std::size_t i) {
    std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
    for (std::size_t s = 0; s < given_[i].size(); ++s) {
      given_[i][s] = kNoLandmark;
      for (std::size_t k = 0; k < positions_.size(); ++k) {
        const double distance = Distance(Seen(i, s), positions_[k]);
        if (distance <= gate_m_) pairs.emplace_back(distance, s, k);
      }
    }
    std::ranges::sort(pairs);
    std::vector<std::size_t> taken;
    for (const auto& [distance, s, k] : pairs) {
      if (given_[i][s] != kNoLandmark || std::ranges::find(taken, k) != taken.end()) continue;
      given_[i][s] = static_cast<std::int32_t>(k);
      taken.push_back(k);
    }
  }

  void Begin(std::size_t i) {
    for (std::size_t s = 0; s < given_[i].size(); ++s) {
      if (given_[i][s] != kNoLandmark) continue;
      given_[i][s] = static_cast<std::int32_t>(positions_.size());
      positions_.push_back(Seen(i, s));
    }
  }

  void Move() {
    std::vector<Point> sum(positions_.size());
    count_.assign(positions_.size(), 0.0);
    for (std::size_t i = 0; i < images_.size(); ++i) {
      for (std::size_t s = 0; s < given_[i].size(); ++s) {
        if (given_[i][s] == kNoLandmark) continue;
        const auto k = static_cast<std::size_t>(given_[i][s]);
        sum[k].x_m += images_[i].seen[s].x_m;
        sum[k].y_m += images_[i].seen[s].y_m;
        ++count_[k];
      }
    }
    for (std::size_t k = 0; k < positions_.size(); ++k) {
      if (count_[k] > 0) positions_[k] = {sum[k].x_m / count_[k], sum[k].y_m / count_[k]};
    }
  }

  // Keeps the landmarks that `keep` names, in their order.
  void Keep(const std::vector<bool>& keep) {
    std::vector<Point> positions;
    std::vector<double> count;
    std::vector<std::int32_t> now(positions_.size(), kNoLandmark);
    for (std::size_t k = 0; k < positions_.size(); ++k) {
      if (!keep[k]) continue;
      now[k] = static_cast<std::int32_t>(positions.size());
      positions.push_back(positions_[k]);
      count.push_back(count_[k]);
    }
    for (auto& image : given_) {
      for (std::int32_t& k : image) k = k == kNoLandmark ? kNoLandmark : now[static_cast<std::size_t>(k)];
    }
    positions_ = positions;
    count_ = count;
  }

  double Together(std::size_t a, std::size_t b) const {
    double images = 0;
    for (const auto& image : given_) {
      const bool has_a = std::ranges::find(image, static_cast<std::int32_t>(a)) != image.end();
      images += has_a && std::ranges::find(image, static_cast<std::int32_t>(b)) != image.end() ? 1 : 0;
    }
    return images;
  }

  // The nearest landmark within the gate of a range-bearing observation that its image does not show yet.
  std::int32_t Free(std::size_t i, std::size_t s, const std::vector<bool>& keep) const {
    double nearest = gate_m_;
    std::int32_t free = kNoLandmark;
    for (std::size_t k = 0; k < positions_.size(); ++k) {
      const auto index = static_cast<std::int32_t>(k);
      const double distance = Distance(Seen(i, s), positions_[k]);
      if (!keep[k] || distance > nearest) continue;
      if (std::ranges::find(given_[i], index) != given_[i].end()) continue;
      nearest = distance;
      free = index;
    }
    return free;
  }

  // (image, range-bearing observation) of each range-bearing observation that landmark k was given.
  std::vector<std::pair<std::size_t, std::size_t>> GivenTo(std::size_t k) const {
    std::vector<std::pair<std::size_t, std::size_t>> observations;
    for (std::size_t i = 0; i < given_.size(); ++i) {
      for (std::size_t s = 0; s < given_[i].size(); ++s) {
        if (given_[i][s] == static_cast<std::int32_t>(k)) observations.emplace_back(i, s);
      }
    }
    return observations;
  }

  double Looked(const Point& position) const {
    double images = 0;
    for (const ImageObservations& image : images_) images += view_.Holds(image, position) ? 1 : 0;
    return images;
  }

  const std::vector<ImageObservations>& images_;
  const ImageRules& rules_;
  double gate_m_;
  FieldOfView view_;
  std::vector<Point> positions_;
  std::vector<double> count_;
  std::vector<std::vector<std::int32_t>> given_;
  std::vector<Point> shift_;
};

// The rarer of two goes; the next pass gives its range-bearing observations to the other.
void ImageClusters::MergeDoubles() {
  std::vector<bool> keep(positions_.size(), true);
  for (std::size_t a = 0; a < positions_.size(); ++a) {
    for (std::size_t b = a + 1; b < positions_.size(); ++b) {
      if (!keep[a] || !keep[b] || Distance(positions_[a], positions_[b]) > gate_m_) continue;
      if (Together(a, b) > kTogether * std::min(count_[a], count_[b])) continue;
      keep[count_[a] < count_[b] ? a : b] = false;
    }
  }
  Keep(keep);
}

// The rarest first.
void ImageClusters::DropNeedless() {
  std::vector<std::size_t> order(positions_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return count_[k]; });
  std::vector<bool> keep(positions_.size(), true);
  for (const std::size_t k : order) {
    const auto observations = GivenTo(k);
    keep[k] = false;
    std::vector<std::int32_t> others;
    for (const auto& [i, s] : observations) others.push_back(Free(i, s, keep));
    const auto needing = static_cast<double>(std::ranges::count(others, kNoLandmark));
    keep[k] = needing > kNeeded * static_cast<double>(observations.size());
    if (keep[k]) continue;
    for (std::size_t n = 0; n < observations.size(); ++n) {
      given_[observations[n].first][observations[n].second] = others[n];
    }
  }
  Keep(keep);
}

void ImageClusters::DropWeak() {
  std::vector<bool> keep;
  for (std::size_t k = 0; k < positions_.size(); ++k) {
    keep.push_back(count_[k] >= std::max(kLeastCount, kLeastRate * Looked(positions_[k])));
  }
  Keep(keep);
}

ImageLandmarks ImageClusters::Result() const {
  std::vector<std::size_t> order(positions_.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return count_[a] > count_[b]; });
  std::vector<std::int32_t> rank(positions_.size());
  ImageLandmarks result;
  const double floor = rules_.cell_m * rules_.cell_m / 12.0;  // a cell is not a point
  for (const std::size_t k : order) {
    rank[k] = static_cast<std::int32_t>(result.landmarks.size());
    result.landmarks.push_back(
        {positions_[k].x_m, positions_[k].y_m, {floor, 0, 0, floor}, rules_.type, count_[k], 0});
  }
  for (std::size_t i = 0; i < images_.size(); ++i) {
    auto& landmark = result.landmark.emplace_back();
    auto& probability = result.probability.emplace_back();
    for (std::size_t s = 0; s < given_[i].size(); ++s) {
      landmark.push_back(given_[i][s] == kNoLandmark ? kNoLandmark
                                                     : rank[static_cast<std::size_t>(given_[i][s])]);
      double chosen = 0.0, all = std::exp(-0.5 * kGate * kGate);
      for (std::size_t k = 0; k < positions_.size(); ++k) {
        const double errors = Distance(Seen(i, s), positions_[k]) / rules_.sigma_m;
        const double likelihood = std::exp(-0.5 * errors * errors);
        all += likelihood;
        if (static_cast<std::int32_t>(k) == given_[i][s]) chosen = likelihood;
      }
      probability.push_back(given_[i][s] == kNoLandmark ? std::exp(-0.5 * kGate * kGate) / all
                                                        : chosen / all);
      if (landmark.back() == kNoLandmark) continue;
      Landmark& l = result.landmarks[static_cast<std::size_t>(landmark.back())];
      const double dx = images_[i].seen[s].x_m - l.x_m, dy = images_[i].seen[s].y_m - l.y_m;
      l.covariance_m2[0] += dx * dx / l.count;
      l.covariance_m2[1] += dx * dy / l.count;
      l.covariance_m2[2] += dx * dy / l.count;
      l.covariance_m2[3] += dy * dy / l.count;
    }
  }
  return result;
}

}  // namespace

void AppendImages(const RobotSteps& steps, int type, std::size_t robot, const std::vector<double>& x_m,
                  const std::vector<double>& y_m, const std::vector<double>& correction_rad,
                  std::vector<ImageObservations>* images) {
  for (std::size_t s = 0; s < x_m.size(); ++s) {
    ImageObservations image{{x_m[s], y_m[s]}, steps.odo_heading_rad[s] + correction_rad[s], {}, robot, {}};
    const double cosine = std::cos(correction_rad[s]), sine = std::sin(correction_rad[s]);
    for (std::int32_t k = steps.first_observation[s]; k < steps.first_observation[s + 1]; ++k) {
      const Observation& o = steps.observations[static_cast<std::size_t>(k)];
      if (o.type != type || o.contact()) continue;
      image.seen.push_back({x_m[s] + cosine * o.x_m - sine * o.y_m, y_m[s] + sine * o.x_m + cosine * o.y_m});
      image.observation.push_back(k);
    }
    if (!image.seen.empty()) images->push_back(std::move(image));
  }
}

ImageLandmarks FindImageLandmarks(const std::vector<ImageObservations>& images, const ImageRules& rules) {
  ImageClusters clusters(images, rules);
  for (int pass = 0; pass < kPasses; ++pass) {
    clusters.Pass(/*births=*/pass < kPasses / 2);
    clusters.MergeDoubles();
    clusters.DropWeak();
  }
  clusters.DropNeedless();
  for (int pass = 0; pass < kPasses / 2; ++pass) clusters.Pass(/*births=*/false);
  clusters.DropWeak();
  return clusters.Result();
}

}  // namespace cairn::landmark_map
