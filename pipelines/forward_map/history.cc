#include "pipelines/forward_map/history.h"

namespace cairn::forward_map {
namespace {

template <class T>
void Append(const Blob* history, const std::string& name, T value, Blob* blob) {
  std::vector<T> values;
  if (history != nullptr) {
    const auto before = history->Get<T>(name);
    values.assign(before.begin(), before.end());
  }
  values.push_back(value);
  blob->PutVector(name, values);
}

}  // namespace

Evidence SumOf(const std::vector<Evidence>& evidence) {
  Evidence sum;
  for (const Evidence& e : evidence) sum.Add(e);
  return sum;
}

Blob EvidenceBlob(const std::vector<Evidence>& evidence) {
  Blob blob;
  for (std::size_t k = 0; k < evidence.size(); ++k)
    blob.PutAll(std::to_string(k) + "/", evidence[k].ToBlob());
  return blob;
}

std::vector<Evidence> EvidenceOf(const Blob& blob) {
  std::vector<Evidence> evidence;
  for (std::size_t k = 0; k < blob.fields().size(); ++k)
    evidence.push_back(Evidence::Of(blob.Sub(std::to_string(k) + "/")));
  return evidence;
}

Blob WithRow(const Blob* history, const Evidence& evidence, double target_nats, const MapState& map) {
  Blob blob;
  Append(history, "history/log_likelihood", evidence.log_likelihood, &blob);
  Append(history, "history/target", target_nats, &blob);
  Append(history, "history/expected_log_likelihood", evidence.log_likelihood - evidence.entropy, &blob);
  Append(history, "history/occupied", static_cast<std::int64_t>(map.CountOccupied()), &blob);
  return blob;
}

}  // namespace cairn::forward_map
