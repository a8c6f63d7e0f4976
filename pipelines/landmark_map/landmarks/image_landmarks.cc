#include "pipelines/landmark_map/landmarks/image_landmarks.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

namespace cairn::landmark_map {
namespace {

constexpr double kGate = 3.0;  // standard deviations
constexpr int kPasses = 12;
constexpr double kLeastCount = 2.0;
constexpr double kLeastRate = 0.1;  // seen in so many of the images that looked there
constexpr double kTogether = 0.1;   // of its images show the other too: they are two
constexpr double kNeeded = 0.02;    // of its range-bearing observations no other landmark could have
constexpr double kLooksKnown = 4;   // how often a landmark is seen is known as after so many looks at it
constexpr double kFew = 1;          // nats against a landmark that is seen a few times only
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
  double area_m2() const { return range_m * range_m * half_rad; }
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

// ln x (x + 1) … (x + n - 1).
double LogRising(double x, double n) {
  double sum = 0;
  for (double i = 0; i < n; ++i) sum += std::log(x + i);
  return sum;
}
double LogChoose(double n, double k) { return LogRising(n - k + 1, k) - LogRising(1, k); }

// Which images would have shown what has no name, were it there. Those that show names alone are of the same
// sensor where a good part of the robot's others show names, too.
std::vector<bool> LookedForNameless(const std::vector<ImageObservations>& images) {
  constexpr double kSameSensor = 0.2;
  std::map<std::size_t, std::pair<double, double>> of_robot;  // with names beside, all
  for (const ImageObservations& image : images) {
    if (image.seen.empty()) continue;
    of_robot[image.robot].first += std::ranges::any_of(image.named, &NamedInImage::shown) ? 1 : 0;
    ++of_robot[image.robot].second;
  }
  std::vector<bool> looked;
  for (const ImageObservations& image : images) {
    const auto [beside, all] = of_robot[image.robot];
    looked.push_back(!image.seen.empty() || (all > 0 && beside >= kSameSensor * all));
  }
  return looked;
}

class ImageClusters {
 public:
  ImageClusters(const std::vector<ImageObservations>& images, const ImageRules& rules,
                const std::vector<Point>& named)
      : images_(images),
        rules_(rules),
        gate_m_(kGate * rules.sigma_m),
        view_(images),
        names_(named.size()),
        positions_(named),
        count_(named.size(), 0.0) {
    for (const ImageObservations& image : images) given_.emplace_back(image.seen.size(), kNoLandmark);
    shift_.resize(images.size());
    looked_ = LookedForNameless(images);
  }

  void Pass(bool births) {
    for (std::size_t i = 0; i < images_.size(); ++i) {
      if (images_[i].seen.empty()) continue;
      Give(i);
      if (births) Begin(i);
    }
    Move();
  }
  void MergeDoubles();
  void DropNeedless();
  void DropWeak();
  void DropAccidental();
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
      for (const NamedInImage& seen : images_[i].named) {
        const Point& to = positions_[static_cast<std::size_t>(seen.landmark)];
        if (Distance({seen.position.x_m + shift_[i].x_m, seen.position.y_m + shift_[i].y_m}, to) > gate_m_)
          continue;
        sum.x_m += to.x_m - seen.position.x_m;
        sum.y_m += to.y_m - seen.position.y_m;
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
      if (ShowsByName(i, k)) continue;
      given_[i][s] = static_cast<std::int32_t>(k);
      taken.push_back(k);
    }
  }

  bool IsNamed(std::size_t k) const { return k < names_; }
  bool ShowsByName(std::size_t i, std::size_t k) const {
    return IsNamed(k) && std::ranges::any_of(images_[i].named, [&](const NamedInImage& seen) {
             return seen.shown && seen.landmark == static_cast<std::int32_t>(k);
           });
  }
  // By name or not.
  bool Shows(std::size_t i, std::size_t k) const {
    return std::ranges::find(given_[i], static_cast<std::int32_t>(k)) != given_[i].end() || ShowsByName(i, k);
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
      if (count_[k] > 0 && !IsNamed(k)) positions_[k] = {sum[k].x_m / count_[k], sum[k].y_m / count_[k]};
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
    for (std::size_t i = 0; i < given_.size(); ++i) images += Shows(i, a) && Shows(i, b) ? 1 : 0;
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
      if (Shows(i, k)) continue;
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

  double OddsOf(std::size_t k, double unexplained, double rate) const;

  double Looked(const Point& position) const {
    double images = 0;
    for (std::size_t i = 0; i < images_.size(); ++i)
      images += looked_[i] && view_.Holds(images_[i], position) ? 1 : 0;
    return images;
  }

  // Some see further than the most do.
  double Looks(std::size_t k) const { return std::max(count_[k], Looked(positions_[k])); }

  const std::vector<ImageObservations>& images_;
  const ImageRules& rules_;
  double gate_m_;
  FieldOfView view_;
  std::vector<bool> looked_;  // [image]: for what has no name
  std::size_t names_;         // the first of them have names
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
      if (IsNamed(b)) continue;
      const bool named = IsNamed(a);
      if (Together(a, b) > kTogether * (named ? count_[b] : std::min(count_[a], count_[b]))) continue;
      keep[!named && count_[a] < count_[b] ? a : b] = false;
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
    if (IsNamed(k)) continue;
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
    keep.push_back(IsNamed(k) || count_[k] >= std::max(kLeastCount, kLeastRate * Looked(positions_[k])));
  }
  Keep(keep);
}

// What is `unexplained` falls anywhere in what images show.
double ImageClusters::OddsOf(std::size_t k, double unexplained, double rate) const {
  const double images_m2 = view_.area_m2() * static_cast<double>(std::ranges::count(looked_, true));
  const double beside = unexplained * std::numbers::pi * gate_m_ * gate_m_ / images_m2;
  return LogOddsOfLandmark(count_[k], Looks(k), rate, unexplained, beside);
}

// The rarest first: what they leave is of no landmark either.
void ImageClusters::DropAccidental() {
  double unexplained = 0, seen = 0, looks = 0;
  for (const auto& image : given_) unexplained += static_cast<double>(std::ranges::count(image, kNoLandmark));
  if (unexplained == 0) return;
  std::vector<std::size_t> order(positions_.size() - names_);
  std::iota(order.begin(), order.end(), names_);
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return count_[k]; });
  for (const std::size_t k : order) {
    seen += count_[k];
    looks += Looks(k);
  }
  const double rate = (seen + 1) / (looks + 2);
  std::vector<bool> keep(positions_.size(), true);
  for (const std::size_t k : order) {
    keep[k] = OddsOf(k, unexplained, rate) > kFew;
    if (!keep[k]) unexplained += count_[k];
  }
  Keep(keep);
}

ImageLandmarks ImageClusters::Result() const {
  std::vector<std::size_t> order(positions_.size() - names_);
  std::iota(order.begin(), order.end(), names_);
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) { return count_[a] > count_[b]; });
  std::vector<std::int32_t> rank(positions_.size());
  std::iota(rank.begin(), rank.end(), 0);
  ImageLandmarks result;
  const double floor = rules_.cell_m * rules_.cell_m / 12.0;  // a cell is not a point
  for (const std::size_t k : order) {
    rank[k] = static_cast<std::int32_t>(names_ + result.landmarks.size());
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
      if (landmark.back() < static_cast<std::int32_t>(names_)) continue;
      Landmark& l = result.landmarks[static_cast<std::size_t>(landmark.back()) - names_];
      const double dx = images_[i].seen[s].x_m - l.x_m, dy = images_[i].seen[s].y_m - l.y_m;
      l.covariance_m2[0] += dx * dx / l.count;
      l.covariance_m2[1] += dx * dy / l.count;
      l.covariance_m2[2] += dx * dy / l.count;
      l.covariance_m2[3] += dy * dy / l.count;
    }
  }
  return result;
}

// When each of the steps' observations was made: of several rows, where they show one landmark.
std::vector<std::set<double>> SeenAt(const RobotSteps& steps, std::span<const double> row_time_s) {
  std::vector<std::set<double>> times(row_time_s.empty() ? 0 : steps.observations.size());
  for (std::size_t i = 0; i < row_time_s.size(); ++i) {
    const std::int32_t k = steps.row_observation[i];
    if (k >= 0) times[static_cast<std::size_t>(k)].insert(row_time_s[i]);
  }
  return times;
}

}  // namespace

void AppendImages(const RobotSteps& steps, int type, std::size_t robot, const std::vector<double>& x_m,
                  const std::vector<double>& y_m, const std::vector<double>& correction_rad,
                  std::span<const double> row_time_s, std::vector<ImageObservations>* images) {
  const std::vector<std::set<double>> seen_at = SeenAt(steps, row_time_s);
  for (std::size_t s = 0; s < x_m.size(); ++s) {
    ImageObservations image{{x_m[s], y_m[s]}, steps.odo_heading_rad[s] + correction_rad[s], {}, robot, {}};
    const double cosine = std::cos(correction_rad[s]), sine = std::sin(correction_rad[s]);
    const auto laid_out = [&](const Observation& o) {
      return Point{x_m[s] + cosine * o.x_m - sine * o.y_m, y_m[s] + sine * o.x_m + cosine * o.y_m};
    };
    std::set<double> shown_at;
    for (std::int32_t k = steps.first_observation[s]; k < steps.first_observation[s + 1]; ++k) {
      const Observation& o = steps.observations[static_cast<std::size_t>(k)];
      if (o.type != type || o.contact()) continue;
      image.seen.push_back(laid_out(o));
      image.observation.push_back(k);
      if (seen_at.empty()) continue;
      const std::set<double>& times = seen_at[static_cast<std::size_t>(k)];
      shown_at.insert(times.begin(), times.end());
    }
    if (image.seen.empty() && seen_at.empty()) continue;
    for (std::int32_t k = steps.first_observation[s]; k < steps.first_observation[s + 1]; ++k) {
      const Observation& o = steps.observations[static_cast<std::size_t>(k)];
      if (seen_at.empty() || o.type >= type || o.contact()) continue;
      const bool shown = std::ranges::any_of(seen_at[static_cast<std::size_t>(k)],
                                             [&](double time_s) { return shown_at.contains(time_s); });
      image.named.push_back({o.type, laid_out(o), shown});
    }
    if (!image.seen.empty() || !image.named.empty()) images->push_back(std::move(image));
  }
}

double LogOddsOfLandmark(double count, double looks, double rate, double false_ones, double beside) {
  const double missed = looks - count, seen = kLooksKnown * rate,
               not_seen = kLooksKnown - seen;  // of a beta distribution
  const double landmark = LogChoose(looks, count) + LogRising(seen, count) + LogRising(not_seen, missed) -
                          LogRising(kLooksKnown, looks);
  const double of_one = std::min(0.5, beside);
  const double chance = std::log(false_ones / count) + LogChoose(looks - 1, count - 1) +
                        (count - 1) * std::log(of_one) + missed * std::log1p(-of_one);
  return landmark - chance;
}

ImageLandmarks FindImageLandmarks(const std::vector<ImageObservations>& images, const ImageRules& rules,
                                  const std::vector<Point>& named) {
  ImageClusters clusters(images, rules, named);
  for (int pass = 0; pass < kPasses; ++pass) {
    clusters.Pass(/*births=*/pass < kPasses / 2);
    clusters.MergeDoubles();
    clusters.DropWeak();
  }
  clusters.DropNeedless();
  for (int pass = 0; pass < kPasses / 2; ++pass) clusters.Pass(/*births=*/false);
  clusters.DropWeak();
  clusters.DropAccidental();
  return clusters.Result();
}

}  // namespace cairn::landmark_map
