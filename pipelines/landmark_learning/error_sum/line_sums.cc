#include "pipelines/landmark_learning/error_sum/line_sums.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>

#include "pipelines/landmark_learning/error_sum/lanes.h"

namespace cairn::landmark_learning {
namespace {

using L = Lanes<double>;

void AddTo(double* sum, L::Register value) { L::Store(sum, L::Add(L::Load(sum), value)); }

// Moments of what lies on one side, about a point that moves away from it: sums of h, of distance times h,
// and of squares times h.
template <bool kSquared>
struct Moments {
  L::Register zeroth = L::Broadcast(0.0), first = zeroth, second = zeroth;

  void MoveAway(double by) {
    const auto step = L::Broadcast(by);
    // sum (d + s)^2 h = second + s (2 first + s zeroth)
    if constexpr (kSquared) second = L::Fma(step, L::Fma(step, zeroth, L::Add(first, first)), second);
    first = L::Fma(step, zeroth, first);
  }
  void Take(const double* h) { zeroth = L::Add(zeroth, L::Load(h)); }
  // One that lies `distance` away already.
  void TakeFrom(double distance, const double* h) {
    const auto d = L::Broadcast(distance), value = L::Load(h);
    zeroth = L::Add(zeroth, value);
    first = L::Fma(d, value, first);
    if constexpr (kSquared) second = L::Fma(L::Mul(d, d), value, second);
  }
  void Join(const Moments& other) {
    zeroth = L::Add(zeroth, other.zeroth);
    first = L::Add(first, other.first);
    if constexpr (kSquared) second = L::Add(second, other.second);
  }
  void Give(double* weighted, double* believed) const {
    if (weighted != nullptr) AddTo(weighted, kSquared ? second : first);
    if (believed != nullptr) AddTo(believed, zeroth);
  }
};

}  // namespace

LineSums::LineSums(const std::vector<double>& t, double reach, bool squared)
    : reach_(reach), squared_(squared) {
  left_.row.resize(t.size());
  std::iota(left_.row.begin(), left_.row.end(), 0);
  const auto where = [&](int k) { return t[static_cast<std::size_t>(k)]; };
  if (!std::ranges::is_sorted(left_.row, {}, where)) std::ranges::stable_sort(left_.row, {}, where);
  right_.row.assign(left_.row.rbegin(), left_.row.rend());
  for (const int k : left_.row) left_.where.push_back(where(k));
  for (const int k : right_.row) right_.where.push_back(-where(k));
}

// Adds what lies before each sample.
template <bool kSquared>
void LineSums::Sweep(const Order& order, const double* h, double* weighted, double* believed) const {
  using Sums = Moments<kSquared>;
  const int *rows = order.row.data(), count = static_cast<int>(order.row.size());
  const double* where = order.where.data();
  const auto row = [&](auto* table, int i) {
    return table == nullptr ? table : table + static_cast<std::ptrdiff_t>(rows[i]) * kLineFeatures;
  };
  std::vector<Sums> before;  // [i - low]: of samples i to the anchor, about the anchor
  for (int a = 0, reached = 0; a < count;) {
    const int anchor = a;
    const double from = where[anchor];
    while (from - where[reached] > reach_) ++reached;
    const int low = reached;
    before.resize(static_cast<std::size_t>(anchor - low) + 1);
    Sums sums;
    for (int i = anchor - 1; i >= low; --i) {
      sums.TakeFrom(from - where[i], row(h, i));
      before[static_cast<std::size_t>(i - low)] = sums;
    }
    Sums since;
    for (double last = from; a < count; ++a) {
      const double here = where[a];
      while (here - where[reached] > reach_) ++reached;
      if (reached > anchor) break;
      since.MoveAway(here - last);
      last = here;
      if (reached < anchor) {
        Sums both = before[static_cast<std::size_t>(reached - low)];
        both.MoveAway(here - from);
        both.Join(since);
        both.Give(row(weighted, a), row(believed, a));
      } else {
        since.Give(row(weighted, a), row(believed, a));
      }
      since.Take(row(h, a));
    }
  }
}

void LineSums::Add(const double* h, double* weighted, double* believed) const {
  for (const Order* order : {&left_, &right_}) {
    if (squared_)
      Sweep<true>(*order, h, weighted, believed);
    else
      Sweep<false>(*order, h, weighted, believed);
  }
  if (believed == nullptr) return;
  const std::size_t cells = left_.row.size() * kLineFeatures;
  // A sample may be taken for itself.
  for (std::size_t i = 0; i < cells; i += L::kCount) AddTo(believed + i, L::Load(h + i));
}

double LineSums::Bound() const {
  std::size_t most = 0;
  for (std::size_t a = 0, first = 0; a < left_.where.size(); ++a) {
    while (left_.where[a] - left_.where[first] > reach_) ++first;
    most = std::max(most, a - first);
  }
  return (4.0 * static_cast<double>(most) + 8.0) * std::numeric_limits<double>::epsilon() / 2.0;
}

}  // namespace cairn::landmark_learning
