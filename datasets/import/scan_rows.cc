#include "datasets/import/scan_rows.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace cairn::datasets {
namespace {

template <class T>
Array TakeArray(Spool* values, std::size_t rows, std::size_t beams) {
  Result<Array> array = values->Take(DTypeOf<T>(), sizeof(T),
                                     {static_cast<std::int64_t>(rows), static_cast<std::int64_t>(beams)});
  if (!array.ok()) throw NotStored{array.status()};
  return std::move(array).value();
}

bool AreAll(const SpooledRows<std::size_t>& rows, std::size_t count) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i] != i) return false;
  return rows.size() == count;
}

// A row of which some beams are kept.
template <class T>
std::span<const T> RowOf(const Array& array, std::size_t row, const std::vector<bool>& beams,
                         std::vector<T>* kept) {
  const auto count = static_cast<std::size_t>(array.shape()[1]);
  const std::span<const T> all = array.As<T>().subspan(row * count, count);
  if (beams.empty()) return all;
  kept->clear();
  for (std::size_t i = 0; i < count; ++i)
    if (beams[i]) kept->push_back(all[i]);
  return *kept;
}

}  // namespace

void ScanRows::Add(std::span<const double> range_m, double least_m, std::span<const float> intensity) {
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  row_.resize(beams_);
  std::size_t answered = 0;
  for (std::size_t i = 0; i < beams_; ++i) {
    const double range = range_m[i];
    const bool answers = range >= least_m && range > 0 && range < max_range_m_;
    row_[i] = answers ? range : std::numeric_limits<double>::quiet_NaN();
    answered += answers ? 1 : 0;
  }
  range_m_.Add<double>(row_);
  unanswered_ += static_cast<std::int64_t>(beams_ - answered);
  ++rows_;
  Hasher hash;
  hash.Add(std::as_bytes(range_m));
  hash.Add(std::as_bytes(intensity));
  hash_.push_back(hash.Finish());
  if (intensity.empty() && intensity_rows_ == 0) return;
  const std::vector<float> none(intensity.empty() || intensity_rows_ + 1 < rows_ ? beams_ : 0, kNone);
  while (intensity_rows_ + 1 < rows_) AddIntensity(none);
  AddIntensity(intensity.empty() ? none : intensity);
}

void ScanRows::AddIntensity(std::span<const float> intensity) {
  if (!first_intensity_) first_intensity_ = intensity.front();
  const auto differs = [&](float one) { return !std::isnan(one) && one != *first_intensity_; };
  intensities_differ_ = intensities_differ_ || std::ranges::any_of(intensity, differs);
  intensity_.Add(intensity);
  ++intensity_rows_;
}

ScanRows::Taken ScanRows::Take(const SpooledRows<std::size_t>& rows, const std::vector<bool>& beams) && {
  Taken all{TakeArray<double>(&range_m_, rows_, beams_), std::nullopt, unanswered_};
  if (intensity_rows_ > 0) all.intensity = TakeArray<float>(&intensity_, rows_, beams_);
  if (AreAll(rows, rows_) && beams.empty()) {
    if (!intensities_differ_) all.intensity.reset();
    return all;
  }
  const auto left = beams.empty() ? beams_ : static_cast<std::size_t>(std::ranges::count(beams, true));
  ScanRows kept(range_m_.folder(), left, max_range_m_);
  std::vector<double> range_m;
  std::vector<float> intensity;
  SpooledRows<std::size_t> in_order(range_m_.folder());
  const std::size_t at_once = std::max<std::size_t>((1 << 20) / (beams_ * sizeof(double)), 1);
  for (const std::size_t row : rows) {
    kept.Add(RowOf(all.range_m, row, beams, &range_m), 0,
             all.intensity ? RowOf(*all.intensity, row, beams, &intensity) : std::span<const float>());
    in_order.push_back(in_order.size());
    if (in_order.size() % at_once != 0) continue;
    all.range_m.LetGo(all.range_m.bytes());
    if (all.intensity) all.intensity->LetGo(all.intensity->bytes());
  }
  return std::move(kept).Take(in_order, {});
}

}  // namespace cairn::datasets
