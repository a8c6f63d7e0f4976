#include "pipelines/localization/result.h"

#include <fmt/format.h>

namespace cairn::localization {

template <class S, class F>
void ResultRows::Visit(S& rows, const F& f) {
  f("step/traverse", rows.traverse_);
  f("step/run", rows.run_);
  f("step/sample", rows.sample_);
  f("step/travelled_m", rows.travelled_m_);
  f("step/mean_x_m", rows.mean_x_m_);
  f("step/mean_y_m", rows.mean_y_m_);
  f("step/mode_x_m", rows.mode_x_m_);
  f("step/mode_y_m", rows.mode_y_m_);
  f("step/spread_m", rows.spread_m_);
  f("step/off_label_m", rows.off_label_m_);
  f("step/lead_nats", rows.lead_nats_);
  f("step/expected_lead_nats", rows.expected_lead_nats_);
  f("step/entries", rows.entries_);
  f("belief/position", rows.position_);
  f("belief/probability", rows.probability_);
}

void ResultRows::Add(std::size_t number, const Source& source, const Traverse& traverse,
                     const Localized& localized) {
  for (std::size_t k = 0; k < localized.steps.size(); ++k) {
    const Localized::Step& step = localized.steps[k];
    const Run& run = source.runs[traverse.run];
    const std::size_t sample = k == 0 ? traverse.start : traverse.stops[k - 1].sample;
    traverse_.push_back(static_cast<std::int32_t>(number));
    run_.push_back(run.index);
    sample_.push_back(static_cast<std::int32_t>(sample));
    travelled_m_.push_back(k == 0 ? 0.0 : traverse.stops[k - 1].travelled_m);
    mean_x_m_.push_back(step.estimate.mean.x_m);
    mean_y_m_.push_back(step.estimate.mean.y_m);
    mode_x_m_.push_back(step.estimate.mode.x_m);
    mode_y_m_.push_back(step.estimate.mode.y_m);
    spread_m_.push_back(step.estimate.spread_m);
    off_label_m_.push_back(DistanceM(step.estimate.mean, run.positions[sample]));
    lead_nats_.push_back(step.lead.nats);
    expected_lead_nats_.push_back(step.lead.expected_nats);
    entries_.push_back(static_cast<std::int64_t>(step.position.size()));
    position_.insert(position_.end(), step.position.begin(), step.position.end());
    probability_.insert(probability_.end(), step.probability.begin(), step.probability.end());
  }
}

void ResultRows::Append(const Blob& rows) {
  Visit(*this, [&]<class T>(const char* name, std::vector<T>& values) {
    const auto more = rows.Get<T>(name);
    values.insert(values.end(), more.begin(), more.end());
  });
}

Blob ResultRows::ToBlob() const {
  Blob blob;
  Visit(*this, [&](const char* name, const auto& values) { blob.PutVector(name, values); });
  return blob;
}

std::string ResultRows::Note() const {
  double first = 0.0, last = 0.0;
  int traverses = 0;
  for (std::size_t k = 0; k < travelled_m_.size(); ++k) {
    const bool begins = k == 0 || traverse_[k] != traverse_[k - 1];
    const bool ends = k + 1 == travelled_m_.size() || traverse_[k] != traverse_[k + 1];
    first += begins ? spread_m_[k] : 0.0;
    last += ends ? spread_m_[k] : 0.0;
    traverses += ends ? 1 : 0;
  }
  return fmt::format(
      "{} traverses: sure to within {:.2f} m on average at their ends, {:.2f} m at their starts", traverses,
      last / traverses, first / traverses);
}

Blob ResultOf(const Options& options, const Source& source, const Poses& poses, const ResultRows& rows) {
  Blob result = rows.ToBlob();
  PutRows("position/", poses.positions, &result);
  if (source.headings()) {
    result.PutVector("position/heading_rad", poses.heading_rad);
    result.Put("heading", Array::Text(options.heading));
  }
  result.Put("runs", Array::Texts(source.run_names));
  result.Put("feature_name", Array::Texts(source.feature_names));
  result.Put("samples_hash", Array::Text(source.samples_hash));
  result.PutScalar("window_m", options.window_m);
  if (!source.extractors.empty()) result.Put("extractors", Array::Texts(source.extractors));
  for (std::size_t n = 0; n < source.extractor.size(); ++n)
    result.PutAll(fmt::format("extractor/{}/", n), BlobOf(source.extractor[n]));
  return result;
}

}  // namespace cairn::localization
