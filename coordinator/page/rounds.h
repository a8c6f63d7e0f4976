// What a job's log says of its rounds: the curve of a job as it comes into being.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "schema/wire.pb.h"

namespace cairn::page {

// A figure of a round, which the pipeline's note tells: "log-likelihood -1234.56".
struct Figure {
  std::string name, unit;
  double value = 0;
};

struct RoundLine {
  std::string stage = {};
  std::uint64_t number = 0;
  double seconds = 0;  // it took
  double work_s = 0;   // of all workers together
  std::uint32_t tasks = 0;
  std::string note = {};
  std::vector<Figure> figures = {};
};

// The figures that a pipeline's note may hold: those of a table in the source.
std::vector<Figure> FiguresIn(const std::string& note);

// "stage 'map', round 3: 12 tasks in 0.8 s, 3.1 s of work: iteration 3". False: the line tells of no round.
bool ReadRoundLine(const std::string& text, RoundLine* round);

// What a page keeps of a job's log: its last lines, and all rounds that they tell of.
class JobHistory {
 public:
  void Add(const std::vector<wire::LogLine>& lines);

  const std::vector<wire::LogLine>& lines() const { return lines_; }
  const std::vector<RoundLine>& rounds() const { return rounds_; }
  std::uint64_t last() const { return lines_.empty() ? 0 : lines_.back().number(); }

 private:
  std::vector<wire::LogLine> lines_;
  std::vector<RoundLine> rounds_;
};

// Charts of the figures over rounds, as SVG within HTML; empty where there is nothing to draw yet.
std::string ChartsHtml(const std::vector<RoundLine>& rounds);

// A row for each figure of each round, with a head.
std::string RoundsCsv(const std::vector<RoundLine>& rounds);

}  // namespace cairn::page
