#include "pipelines/landmark_learning/history.h"

#include <string>

namespace cairn::landmark_learning {
namespace {

std::string NameOf(std::size_t block) { return "history/" + std::to_string(block); }

std::vector<double> Column(const Blob& blob, const char* name) {
  const auto values = blob.Get<double>(name);
  return {values.begin(), values.end()};
}

}  // namespace

void HistoryRows::Append(const HistoryRows& more) {
  error.insert(error.end(), more.error.begin(), more.error.end());
  validation.insert(validation.end(), more.validation.begin(), more.validation.end());
  norm.insert(norm.end(), more.norm.begin(), more.norm.end());
}

Blob HistoryRows::ToBlob() const {
  Blob blob;
  blob.PutVector("error", error);
  blob.PutVector("validation", validation);
  blob.PutVector("norm", norm);
  return blob;
}

HistoryRows HistoryRows::FromBlob(const Blob& blob) {
  return {Column(blob, "error"), Column(blob, "validation"), Column(blob, "norm")};
}

void History::Add(double error, double validation, double norm) {
  tail_.Append({{error}, {validation}, {norm}});
}

void History::Share(const State& before, const Inputs& inputs, Step* step) {
  auto& names = *step->plan.mutable_state()->mutable_blobs();
  if (tail_.size() >= kTail) {
    HistoryRows rows = std::move(tail_);
    tail_ = {};
    while (!blocks_.empty() && blocks_.back() == static_cast<std::int64_t>(rows.size())) {
      HistoryRows merged = HistoryRows::FromBlob(*inputs.Get(NameOf(blocks_.size() - 1)));
      merged.Append(rows);
      rows = std::move(merged);
      blocks_.pop_back();
    }
    names[NameOf(blocks_.size())] = step->Share(rows.ToBlob());
    blocks_.push_back(static_cast<std::int64_t>(rows.size()));
  }
  for (std::size_t block = 0; block < blocks_.size(); ++block) {
    const std::string name = NameOf(block);
    if (!names.contains(name)) names[name] = before.blobs().at(name);
  }
}

HistoryRows History::All(const Inputs& inputs) const {
  HistoryRows all;
  for (std::size_t block = 0; block < blocks_.size(); ++block)
    all.Append(HistoryRows::FromBlob(*inputs.Get(NameOf(block))));
  all.Append(tail_);
  return all;
}

Blob History::ToBlob() const {
  Blob blob = tail_.ToBlob();
  blob.PutVector("blocks", blocks_);
  return blob;
}

History History::FromBlob(const Blob& blob) {
  History history;
  history.tail_ = HistoryRows::FromBlob(blob);
  const auto blocks = blob.Get<std::int64_t>("blocks");
  history.blocks_.assign(blocks.begin(), blocks.end());
  return history;
}

}  // namespace cairn::landmark_learning
