#include "datasets/reproduce/landmark_figures.h"

#include <algorithm>
#include <cmath>

#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/landmarks.h"
#include "datasets/evaluate/track.h"
#include "datasets/reproduce/belief_view.h"
#include "datasets/reproduce/figure_panels.h"
#include "datasets/simulate_loop.h"

namespace cairn::datasets {
namespace {

using report::PanelPicture;

constexpr double kNearM = 2.0;  // "there"
constexpr const char* kEmMap = "em_map";

class Figures {
 public:
  Figures(const LandmarkStudy& study, const std::map<std::string, Blob>& results)
      : study_(study), results_(results), map_score_(Score("map", "first")) {}

  std::vector<PaperFigure> Make() {
    Motion();
    Perception();
    BetaEarly();
    RawData();
    MostLikelyMap();
    FirstRevisit();
    Prefixes();
    SecondWorld();
    BetaTables();
    SecondRobot();
    ForwardOnly();
    return std::move(figures_);
  }

 private:
  const Blob& Result(const std::string& stage) const {
    const auto it = results_.find(stage);
    if (it == results_.end()) throw InputError("there is no result of the stage '" + stage + "'");
    return it->second;
  }
  const Blob& Input(const std::string& name) const { return study_.inputs.at(name); }
  Evaluation Score(const std::string& stage, const std::string& log) const {
    return Evaluate(Result(stage), Input(log));
  }
  void Add(const char* file, const char* title, const char* claim, const std::string& measured,
           std::string png) {
    figures_.push_back({file, title, claim, measured, std::move(png)});
  }

  // The true place of a robot in the frame of a map of the first log.
  PointM TruePlace(const Evaluation& map, const Blob& log, std::size_t robot, double time_s) const {
    const Track truth = ReadTrack(log, "truth/robot/" + std::to_string(robot) + "/poses/");
    const auto pose = PoseAt(truth, time_s);
    if (!pose) throw InputError("the log does not say where the robot truly is at an observation");
    return Inverse(map.alignment)(PointM{pose->x_m, pose->y_m});
  }

  // With the landmarks of the map in which a robot was looked for.
  PanelPicture BeliefPanel(const std::string& title, const report::Grid& belief, const char* stage) const {
    PanelPicture panel;
    panel.title = title;
    panel.density = belief;
    const report::Scene scene = report::MakeScene(Result(stage), nullptr, nullptr);
    for (const report::MapLandmark& landmark : scene.landmarks) panel.landmarks.push_back(landmark.at);
    return panel;
  }

  void Motion() {
    const BeliefView beliefs(Result("motion"), 0);
    const auto seen = Input("motion_log").Get<double>("robot/0/observations/time_s");
    std::vector<PanelPicture> panels;
    std::string measured = "standard deviation of the position";
    for (std::size_t n = 0; n < seen.size(); ++n) {
      const double way_m = kStraightM * static_cast<double>(n + 1);
      PanelPicture panel =
          RawPanel(Say("(%c) after %.0f m", n == 0 ? 'a' : 'b', way_m), Input("motion_log"), 0, seen[n]);
      panel.marks.clear();
      const report::Grid belief = beliefs.At(beliefs.StepAt(seen[n]));
      panel.density = belief;
      measured += Say("%s %.1f m after %.0f m", n == 0 ? ":" : ",", SpreadM(belief), way_m);
      panels.push_back(std::move(panel));
    }
    report::Box box = report::BoundsOf(panels);
    for (const PanelPicture& panel : panels) {
      PanelPicture alone;
      alone.density = panel.density;
      box = report::Around(box, report::BoundsOf({alone}));
    }
    Add("figure_01.png", "Figure 1: the model of motion",
        "Accumulated uncertainty after moving as the line shows; its bent shape comes from errors of turns "
        "and "
        "ways together.",
        measured + " (errors: 1.2 degrees per root metre, 3% of ways, 5% of turns).",
        report::DrawPanels(panels, box, 2));
  }

  void Perception() {
    const BeliefView beliefs(Result("perception"), 0);
    const report::Grid belief = beliefs.At(0);
    double on_ring = 0, all = 0;
    for (std::size_t i = 0; i < belief.probability.size(); ++i) {
      const PointM at = CentreOf(belief, i);
      const double left = DistanceM(at, {-kBetweenM / 2, 0}), right = DistanceM(at, {kBetweenM / 2, 0});
      all += belief.probability[i];
      if (std::abs(left - kSeenAtM) < 1 || std::abs(right - kSeenAtM) < 1) on_ring += belief.probability[i];
    }
    PanelPicture seen, map;
    seen.title = "(a) where the robot may be that sees a landmark 5 m ahead";
    seen.density = belief;
    seen.landmarks = map.landmarks = {{-kBetweenM / 2, 0}, {kBetweenM / 2, 0}};
    map.title = "(b) the map";
    const double half = kBetweenM / 2 + 8;
    Add("figure_02.png", "Figure 2: the model of perception",
        "A robot that knows nothing of its place sees a landmark about 5 m ahead, in a world of two that "
        "look "
        "alike: circles round both, and a residual elsewhere.",
        Say("%.0f%% of the probability lies within 1 m of the two circles of 5 m.", 100 * on_ring / all),
        report::DrawPanels({seen, map}, {-half, half, -8, 8}, 2));
  }

  // Localization of the reversed data in a map: panels of the belief after each of its first observations.
  std::vector<PanelPicture> BetaPanels(const char* stage, const char* map, std::size_t count,
                                       std::vector<double>* there) const {
    const BeliefView beliefs(Result(stage), 0);
    const Evaluation score = Score(map, "first");
    const auto seen = Input("back").Get<double>("robot/0/observations/time_s");
    const auto forth = Input("first").Get<double>("robot/0/observations/time_s");
    std::vector<PanelPicture> panels;
    for (std::size_t n = 0; n < std::min(count, seen.size()); ++n) {
      const report::Grid belief = beliefs.At(beliefs.StepAt(seen[n]));
      const PointM truth = TruePlace(score, Input("first"), 0, forth[forth.size() - 1 - n]);
      there->push_back(ShareWithin(belief, truth, kNearM));
      PanelPicture panel = BeliefPanel(Say("t = %zu of %zu: %.0f%% within %.0f m of truth", forth.size() - n,
                                           forth.size(), 100 * there->back(), kNearM),
                                       belief, map);
      panel.robot = truth;
      panels.push_back(std::move(panel));
    }
    return panels;
  }

  void BetaEarly() {
    std::vector<double> there;
    const std::vector<PanelPicture> panels = BetaPanels("beta_early", "iterations_2", 9, &there);
    Add("figure_03.png", "Figure 3: a sequence of beta tables",
        "Beta before the map has converged: the distributions are complex and multi-modal.",
        Say("beta with the observation of its own step, in the map of the second iteration; the mass within "
            "%.0f m of truth goes from %.0f%% to %.0f%% in %zu observations.",
            kNearM, 100 * there.front(), 100 * there.back(), there.size()),
        DrawFigure(panels, 3));
  }

  void RawData() {
    const Blob& log = Input("first");
    Add("figure_05.png", "Figure 5a: raw data",
        "2,972 controls; the final odometric error is about 24.9 m in a box of 90 by 90 m.",
        Say("%zu controls, %d observations, final odometric error %.1f m.",
            log.Get<double>("robot/0/odometry/time_s").size(), study_.observations,
            FinalOdometricErrorM(log, 0)),
        DrawFigure({RawPanel("raw odometry, observations", log)}, 1));
  }

  void MostLikelyMap() {
    Add("figure_06.png", "Figure 6a: the most likely map and path",
        "Topologically right; the principle topology was known after two iterations, the landmarks with high "
        "certainty after about four.",
        ScoreText(map_score_) + Say("; topology %s after 2 iterations, %s after 4.",
                                    RightOrWrong(Score("iterations_2", "first")),
                                    RightOrWrong(Score("iterations_4", "first"))),
        DrawFigure({RawPanel("raw odometry", Input("first")),
                    MapPanel("map and most likely path", Result("map"), Input("first"), map_score_)},
                   2));
  }

  // Raw data and map of a prefix; the belief of its last step beneath.
  std::string PrefixPicture(int n, const Evaluation& score) const {
    const Blob& result = Result(n == study_.observations ? "map" : PrefixStage(n));
    const double until_s =
        Input("first").Get<double>("robot/0/observations/time_s")[static_cast<std::size_t>(n - 1)];
    const BeliefView beliefs(result, 0);
    PanelPicture map = MapPanel(Say("map after observation %d: topology %s", n, RightOrWrong(score)), result,
                                Input("first"), score);
    map.density = beliefs.At(beliefs.StepAt(until_s));
    map.density_name = "belief of the last step";
    return DrawFigure({RawPanel(Say("raw data up to observation %d", n), Input("first"), 0, until_s), map},
                      2);
  }

  Evaluation PrefixScore(int n) const {
    return n == study_.observations ? map_score_ : Score(PrefixStage(n), "first");
  }

  void FirstRevisit() {
    const Evaluation score = PrefixScore(study_.revisit);
    Add("figure_07.png", "Figure 7: the first landmark seen again",
        "Even where a small cycle brings but little odometric error, the map gets better.",
        Say("observation %d is the first of a landmark seen before%s: ", study_.revisit,
            study_.revisit == study_.closing ? ", for this drive goes round the large cycle first" : "") +
            ScoreText(score) + ".",
        PrefixPicture(study_.revisit, score));
  }

  void Prefixes() {
    const int first = std::max(2, study_.closing - 2);
    std::map<int, Evaluation> scores;
    int settled = study_.observations;  // right from there on
    for (int n = first; n <= study_.observations; ++n) scores[n] = PrefixScore(n);
    while (settled > first && scores.at(settled - 1).topology_correct.value_or(false)) --settled;
    if (!scores.at(study_.observations).topology_correct.value_or(false)) settled = study_.observations + 1;
    std::string table =
        Say("the large cycle closes with observation %d. Topology by prefix:", study_.closing);
    for (const auto& [n, score] : scores) table += Say(" %d %s,", n, RightOrWrong(score));
    table.pop_back();
    table += settled <= study_.observations ? Say("; right from %d on.", settled)
                                            : std::string("; not right at the end.");
    const int turn = std::clamp(std::max(settled, study_.closing), first + 2, study_.observations);
    const int shown[] = {turn - 2, turn - 1, turn, std::min(turn + 3, study_.observations)};
    static const char* const kFiles[] = {"figure_08.png", "figure_09.png", "figure_10.png", "figure_11.png"};
    static const char* const kTitles[] = {
        "Figure 8: two observations earlier", "Figure 9: an observation earlier",
        "Figure 10: the cycle is closed, the topology right", "Figure 11: three observations later"};
    static const char* const kClaims[] = {
        "After 15 landmarks the most plausible map is topologically wrong; for the last step several places "
        "have "
        "high probability.",
        "After 16 it is still wrong.", "After 17 the topology is right; from this point on it always is.",
        "After 20 it is right."};
    for (int k = 0; k < 4; ++k) {
      Add(kFiles[k], kTitles[k], kClaims[k],
          Say("after observation %d: ", shown[k]) + ScoreText(scores.at(shown[k])) +
              (k == 2 ? ". " + table : "."),
          PrefixPicture(shown[k], scores.at(shown[k])));
    }
  }

  void SecondWorld() {
    const Blob& log = Input("other");
    const Evaluation score = Score("other_map", "other");
    Add("figure_12_13.png", "Figures 12 and 13: a second dataset",
        "Raw data of another part of the building (2,091 controls), and the most likely map with the path.",
        Say("%zu controls, final odometric error %.1f m; ", log.Get<double>("robot/0/odometry/time_s").size(),
            FinalOdometricErrorM(log, 0)) +
            ScoreText(score) + ".",
        DrawFigure({RawPanel("raw data", log),
                    MapPanel("map and most likely path", Result("other_map"), log, score)},
                   2));
  }

  void BetaTables() {
    std::vector<double> there;
    std::vector<PanelPicture> panels = BetaPanels("beta", kEmMap, 5, &there);
    std::string measured = Say("mass within %.0f m of truth after 1, 2, ... observations:", kNearM);
    for (const double share : there) measured += Say(" %.0f%%", 100 * share);
    panels.insert(panels.begin(), UniformPanel(panels));
    Add("figure_14.png", "Figure 14: the last beta tables after convergence",
        "The last beta is uniform; with every step the uncertainty shrinks; after three steps the place is "
        "known with high certainty.",
        measured +
            ". Beta is computed as what it is: localization of the reversed data in the map, the "
            "observation of its own step included.",
        DrawFigure(panels, 3));
  }

  // beta of the last step, before any observation: the same everywhere.
  PanelPicture UniformPanel(const std::vector<PanelPicture>& others) const {
    const report::Box box = report::BoundsOf(others);
    report::Grid grid;
    grid.origin = {box.x_low_m, box.y_low_m};
    grid.cell_m = 1;
    grid.columns = static_cast<std::int64_t>(box.width_m());
    grid.rows = static_cast<std::int64_t>(box.height_m());
    grid.probability.assign(static_cast<std::size_t>(grid.columns * grid.rows), 1.0);
    PanelPicture panel = BeliefPanel("the last beta, before any observation: uniform", grid, kEmMap);
    panel.robot = others.front().robot;
    return panel;
  }

  void SecondRobot() {
    const Evaluation joint = Score("joint", "both");
    const Blob& log = Input("second");
    Add("figure_18ab.png", "Figure 18a, b: a second robot",
        "Its start is unknown; after a single iteration from the first robot's map its place is known with "
        "high "
        "confidence and the map holds both robots' observations.",
        "both robots, one iteration: " + ScoreText(joint) + ".",
        DrawFigure({RawPanel("(a) raw data of the second robot", log),
                    MapPanel("(b) both robots after one iteration", Result("joint"), Input("both"), joint)},
                   2));
    const BeliefView beliefs(Result("alpha"), 0);
    const Evaluation em_map = Score(kEmMap, "first");
    const auto seen = log.Get<double>("robot/0/observations/time_s");
    std::vector<PanelPicture> panels;
    std::string measured = Say("mass within %.0f m of truth after 1, 2, ... observations:", kNearM);
    for (std::size_t n = 0; n < std::min<std::size_t>(6, seen.size()); ++n) {
      const report::Grid belief = beliefs.At(beliefs.StepAt(seen[n]));
      const PointM truth = TruePlace(em_map, log, 0, seen[n]);
      const double there = ShareWithin(belief, truth, kNearM);
      measured += Say(" %.0f%%", 100 * there);
      PanelPicture panel = BeliefPanel(
          Say("(c%zu) alpha(%zu): %.0f%% within %.0f m of truth", n + 1, n + 1, 100 * there, kNearM), belief,
          kEmMap);
      panel.robot = truth;
      panels.push_back(std::move(panel));
    }
    Add("figure_18c.png", "Figure 18c: the second robot's first alpha tables",
        "After one observation it may be at any landmark of the map; after four steps it knows where it is.",
        measured + ".", DrawFigure(panels, 3));
  }

  void ForwardOnly() {
    const Evaluation forward = Score("forward", "first");
    Add("forward_only.png", "Section 6: without revising the past",
        "Any incremental routine that does not revise past location estimates would be bound to fail in such "
        "a "
        "situation (conjectured).",
        "one pass, each observation looked at once: " + ScoreText(forward) +
            ". EM, alpha and beta: " + ScoreText(map_score_) + ".",
        DrawFigure(
            {MapPanel("one pass, nothing revised", Result("forward"), Input("first"), forward),
             MapPanel("with the past revised (alpha beta)", Result("map"), Input("first"), map_score_)},
            2));
  }

  const LandmarkStudy& study_;
  const std::map<std::string, Blob>& results_;
  Evaluation map_score_;
  std::vector<PaperFigure> figures_;
};

}  // namespace

std::vector<PaperFigure> LandmarkFigures(const LandmarkStudy& study,
                                         const std::map<std::string, Blob>& results) {
  return Figures(study, results).Make();
}

}  // namespace cairn::datasets
