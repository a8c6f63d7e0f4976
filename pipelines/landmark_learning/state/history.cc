#include "pipelines/landmark_learning/state/history.h"

#include <string>

namespace cairn::landmark_learning {
namespace {

std::string NameOf(std::size_t block) { return "history/" + std::to_string(block); }

}  // namespace

void HistoryRows::Append(const HistoryRows& more) {
  error.insert(error.end(), more.error.begin(), more.error.end());
  validation.insert(validation.end(), more.validation.begin(), more.validation.end());
  norm.insert(norm.end(), more.norm.begin(), more.norm.end());
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
      HistoryRows merged = Read<HistoryRows>(*inputs.Get(NameOf(blocks_.size() - 1)));
      merged.Append(rows);
      rows = std::move(merged);
      blocks_.pop_back();
    }
    names[NameOf(blocks_.size())] = step->Share(BlobOf(rows));
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
    all.Append(Read<HistoryRows>(*inputs.Get(NameOf(block))));
  all.Append(tail_);
  return all;
}

}  // namespace cairn::landmark_learning
