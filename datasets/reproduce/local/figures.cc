#include "datasets/reproduce/local/figures.h"

#include <algorithm>
#include <functional>
#include <optional>

#include "datasets/evaluate/local.h"
#include "datasets/report/draw_map.h"
#include "datasets/report/pages/local_pictures.h"
#include "datasets/report/pages/pages.h"
#include "datasets/reproduce/figure_panels.h"
#include "datasets/reproduce/local/wall_coverage.h"
#include "datasets/reproduce/occupancy/panels.h"
#include "datasets/reproduce/over_seeds.h"

namespace cairn::datasets {
namespace {

constexpr double kLostM = 1;  // a path that is farther off anywhere is lost

struct Scored {
  const Blob *result, *log;
  LocalEvaluation score;
};

std::vector<Scored> ScoreKind(const LocalStudy& study, const StageResults& results, const OfficeKind& kind) {
  std::vector<Scored> scored;
  for (const std::string& name : kind.logs) {
    const Blob &result = ResultOf(results, name + "_map"), &log = study.inputs.at(name);
    scored.push_back({&result, &log, EvaluateLocal(result, log)});
  }
  return scored;
}

std::string Mean(const std::vector<Scored>& scored, const char* format,
                 const std::function<std::optional<double>(const LocalEvaluation&)>& of) {
  std::vector<double> values;
  for (const Scored& one : scored)
    if (const auto value = of(one.score)) values.push_back(*value);
  if (values.empty()) return "-";
  const OverSeeds over = MeanOverSeeds(values);
  std::string text = Say(format, over.mean);
  if (over.half) text += Say(" +- ") + Say(format, *over.half);
  return text;
}

template <class Measure>
double Sum(const std::vector<Scored>& scored, const Measure& of) {
  double sum = 0;
  for (const Scored& one : scored) sum += of(one.score);
  return sum;
}

// A row a measure, a column a kind of office.
class NumbersTable {
 public:
  explicit NumbersTable(const std::vector<std::pair<std::string, std::vector<Scored>>>& kinds)
      : kinds_(kinds) {
    table_.head = {"measure", "wanted"};
    for (const auto& [title, scored] : kinds)
      table_.head.push_back(title + ", " + std::to_string(scored.size()) +
                            (scored.size() == 1 ? " seed" : " seeds"));
  }

  void Add(const std::string& measure, const std::string& wanted,
           const std::function<std::string(const std::vector<Scored>&)>& of) {
    std::vector<std::string> row{measure, wanted};
    for (const auto& [title, scored] : kinds_) row.push_back(of(scored));
    table_.rows.push_back(std::move(row));
  }

  PaperTable Take() { return std::move(table_); }

 private:
  const std::vector<std::pair<std::string, std::vector<Scored>>>& kinds_;
  PaperTable table_;
};

using Kinds = std::vector<std::pair<std::string, std::vector<Scored>>>;

void AddPathRows(NumbersTable* table) {
  using Score = LocalEvaluation;
  table->Add("odometry alone, mean error", "", [](const auto& s) {
    return Mean(s, "%.3f", [](const Score& e) { return std::optional(e.odometry.mean_m); }) + " m";
  });
  table->Add("optimized path, mean error", "<= 0.25 m", [](const auto& s) {
    return Mean(s, "%.3f", [](const Score& e) { return std::optional(e.path.mean_m); }) + " m";
  });
  table->Add("times smaller, of the means", ">= 5", [](const auto& s) {
    const double raw = Sum(s, [](const Score& e) { return e.odometry.mean_m; }),
                 path = Sum(s, [](const Score& e) { return e.path.mean_m; });
    return Say("%.1f", raw / path);
  });
  table->Add("in the traces' frames, mean error", "<= 0.25 m", [](const auto& s) {
    return Mean(s, "%.3f",
                [](const Score& e) { return e.traces ? std::optional(e.traces->mean_m) : std::nullopt; }) +
           " m";
  });
  table->Add("odometry alone in these frames", "", [](const auto& s) {
    return Mean(s, "%.3f",
                [](const Score& e) {
                  return e.traces ? std::optional(e.traces_odometry.mean_m) : std::nullopt;
                }) +
           " m";
  });
  table->Add("times smaller, of the means", ">= 5", [](const auto& s) {
    const double raw = Sum(s, [](const Score& e) { return e.traces_odometry.mean_m; }),
                 live = Sum(s, [](const Score& e) { return e.traces ? e.traces->mean_m : 0; });
    return live > 0 ? Say("%.1f", raw / live) : "-";
  });
  table->Add("worst error of any path", "", [](const auto& s) {
    double worst = 0;
    for (const Scored& one : s) worst = std::max(worst, one.score.path.worst_m);
    return Say("%.2f m", worst);
  });
  table->Add("lost (a path 1 m off or more)", "0; moved: 1 of 20", [](const auto& s) {
    return Say("%.0f of %zu", Sum(s, [](const Score& e) { return e.path.worst_m >= kLostM ? 1.0 : 0.0; }),
               s.size());
  });
}

WallCoverage CoverageOf(const std::vector<Scored>& scored) {
  WallCoverage coverage;
  for (const Scored& one : scored) coverage.Add(MetallicCoverage(*one.result, *one.log));
  return coverage;
}

std::string WallShare(double part_m, double of_m) {
  return of_m > 0 ? Say("%.0f%% of %.0f m", 100 * part_m / of_m, of_m) : "-";
}

void AddCoverageRows(NumbersTable* table) {
  table->Add("metallic walls within 2 m, by edges", "", [](const auto& s) {
    const WallCoverage c = CoverageOf(s);
    return WallShare(c.by_edges_m, c.wall_m);
  });
  table->Add("by occupancy (hit by 10% of the scans)", "", [](const auto& s) {
    const WallCoverage c = CoverageOf(s);
    return WallShare(c.by_hits_m, c.wall_m);
  });
  table->Add("where occupancy has holes, by edges", "", [](const auto& s) {
    const WallCoverage c = CoverageOf(s);
    return WallShare(c.by_either_m - c.by_hits_m, c.wall_m - c.by_hits_m);
  });
}

void AddOtherRows(NumbersTable* table) {
  using Score = LocalEvaluation;
  table->Add("direction of walls, mean error", "", [](const auto& s) {
    return Mean(s, "%.2f",
                [](const Score& e) { return e.walls ? std::optional(e.walls->error_deg) : std::nullopt; }) +
           " degrees";
  });
  table->Add("under 2 degrees after the first lock", "95%", [](const auto& s) {
    return Mean(s, "%.1f",
                [](const Score& e) {
                  return e.walls ? std::optional(100 * e.walls->within_2_deg) : std::nullopt;
                }) +
           "%";
  });
  table->Add("scans where walls are turned, told", "", [](const auto& s) {
    const std::string told = Mean(s, "%.0f", [](const Score& e) -> std::optional<double> {
      if (!e.walls || !e.walls->other_area_found) return std::nullopt;
      return 100 * *e.walls->other_area_found;
    });
    return told == "-" ? told : told + "%";
  });
  table->Add("loops followed, of them wrong", "", [](const auto& s) {
    return Say("%.0f, %.0f", Sum(s, [](const Score& e) { return static_cast<double>(e.loops.found); }),
               Sum(s, [](const Score& e) { return static_cast<double>(e.loops.wrong); }));
  });
  AddCoverageRows(table);
}

PaperFigure Numbers(const Kinds& kinds) {
  NumbersTable table(kinds);
  AddPathRows(&table);
  AddOtherRows(&table);
  const std::vector<Scored>& scored = kinds.front().second;
  const double raw = Sum(scored, [](const LocalEvaluation& e) { return e.odometry.mean_m; }),
               path = Sum(scored, [](const LocalEvaluation& e) { return e.path.mean_m; });
  return {
      "",
      "Numbers over seeds",
      "The paper has none of these; sections 3.4 and 4.3 speak of walls found and followed, and of a "
      "robot that "
      "\"has remained consistently located while moving\" in short tests.",
      Say("Mean error of the optimized path %.3f m, of odometry alone %.3f m: %.1f times smaller, where no "
          "furniture moves.",
          path / static_cast<double>(scored.size()), raw / static_cast<double>(scored.size()), raw / path),
      "",
      table.Take()};
}

PaperFigure Grid(const report::LocalResult& local) {
  PaperFigure figure{
      "figure_02.png", "Figure 2: local grids",
      "Dominant orientations of cells follow walls and furniture; the current edges approximate walls "
      "well; the histogram of wall orientations has one peak.",
      "No snapshot was kept.", ""};
  const report::LocalSnapshot* shot = report::RichestOf(local);
  if (shot == nullptr) return figure;
  const auto cells = std::ranges::count_if(shot->edge_rad, [](float e) { return e == e; });
  const double most = *std::ranges::max_element(shot->histogram);
  double sum = 0;
  for (const double sector : shot->histogram) sum += sector;
  figure.measured =
      Say("At %.0f s %td cells have an orientation, the last scan shows %zu edges; the histogram's "
          "highest sector holds %.0f%% of it.",
          shot->time_s, cells, shot->edges.size(), sum > 0 ? 100 * most / sum : 0);
  figure.png = report::LocalGridPicture(*shot).Png();
  return figure;
}

PaperFigure Trace(const report::LocalResult& local) {
  PaperFigure figure{
      "figure_03.png", "Figure 3: an edge trace of a long corridor",
      "Distance intervals are narrow and run along the walls, in spite of people who pass and of "
      "metallic walls.",
      "No trace was recorded.", ""};
  const report::LocalTrace* trace = report::LongestOf(local);
  if (trace == nullptr) return figure;
  double width_m = 0, sides = 0;
  for (const report::LocalFeature& feature : trace->features) {
    for (const report::LocalSide* side : {&feature.left, &feature.right}) {
      if (!side->HasEdge()) continue;
      width_m += side->distance_high_m - side->distance_low_m;
      sides += 1;
    }
  }
  const auto features = static_cast<double>(trace->features.size());
  figure.measured =
      Say("%.1f m; %.0f%% of the features' sides have an edge, whose interval of distances is %.3f m "
          "wide on average.",
          features * trace->cell_m, 100 * sides / (2 * features), sides > 0 ? width_m / sides : 0);
  figure.png = report::TracePicture(*trace).Png();
  return figure;
}

PaperFigure Match(const Kinds& kinds) {
  PaperFigure figure{
      "figure_04.png", "Figure 4: immediate traces on recorded ones",
      "Matched with a trace that was recorded before, edges of the local grids lie on the recorded "
      "ones; where there are none occupied cells do.",
      "At no snapshot had matching just put the robot in a trace of before.", ""};
  for (const Scored& one : kinds.front().second) {
    const auto shown =
        report::Superpositions(report::ReadLocalResult(*one.result), report::OdometryOf(*one.log));
    if (shown.empty()) continue;
    figure.measured = Say("The office of %s; the robot's position was corrected within the last two seconds.",
                          one.log == kinds.front().second.front().log ? "the first seed" : "a later seed");
    figure.png = report::SuperposedPicture(shown).Png();
    if (shown.size() > 1) break;
  }
  return figure;
}

PaperFigure Map(const Scored& first) {
  return {"path.png", "Traces and the path put together from them",
          "The paper keeps no global frame; \"we ask only for consistency between adjacent traces\" (4.3).",
          Say("Mean error %.3f m, of odometry alone %.3f m; %lld loops.", first.score.path.mean_m,
              first.score.odometry.mean_m, static_cast<long long>(first.score.loops.found)),
          DrawScenePng(report::LocalSceneOf(*first.result, first.log, &first.score), 1300)};
}

}  // namespace

std::vector<PaperFigure> LocalFigures(const LocalStudy& study, const StageResults& results) {
  Kinds kinds;
  for (const OfficeKind& kind : study.kinds) kinds.emplace_back(kind.title, ScoreKind(study, results, kind));
  const Scored& first = kinds.front().second.front();
  const report::LocalResult local = report::ReadLocalResult(*first.result);
  std::vector<PaperFigure> figures{Grid(local), Trace(local), Match(kinds), Map(first), Numbers(kinds)};
  for (PaperFigure& figure : figures)
    if (figure.png.empty()) figure.file.clear();
  return figures;
}

}  // namespace cairn::datasets
