#include "datasets/reproduce/landmarks/figures.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "datasets/evaluate/evaluate.h"
#include "datasets/evaluate/landmarks.h"
#include "datasets/evaluate/matching/similarity.h"
#include "datasets/evaluate/track.h"
#include "datasets/reproduce/figure_panels.h"
#include "datasets/reproduce/landmarks/belief_view.h"
#include "datasets/simulate/loop.h"

namespace cairn::datasets {
namespace {

using report::PanelPicture;

constexpr double kNearM = 2.0;  // "there"
constexpr const char* kEmMap = "em_map";

bool IsRight(const Evaluation& score) { return score.topology_correct.value_or(false); }

// How far odometry alone is off up to a time, laid over the true path by the best rigid motion.
double OdometryRmseM(const Blob& log, int robot, double until_s) {
  const std::string prefix = "robot/" + std::to_string(robot) + "/odometry/";
  const auto time = log.Get<double>(prefix + "time_s"), turn = log.Get<double>(prefix + "turn_rad"),
             forward = log.Get<double>(prefix + "forward_m");
  const Track truth = ReadTrack(log, "truth/robot/" + std::to_string(robot) + "/poses/");
  std::vector<PointPair> pairs;
  Pose pose;
  for (std::size_t i = 0; i < time.size() && time[i] <= until_s; ++i) {
    pose = Apply(pose, {turn[i], forward[i]});
    if (const auto there = PoseAt(truth, time[i]))
      pairs.push_back({{pose.x_m, pose.y_m}, {there->x_m, there->y_m}});
  }
  return RmseM(pairs, FitRigid(pairs));
}

// The share of a belief within kNearM of any of the points.
double ShareNear(const report::Grid& belief, const std::vector<Point>& points) {
  double all = 0, near = 0;
  for (std::size_t i = 0; i < belief.probability.size(); ++i) {
    const Point at = CentreOf(belief, i);
    all += belief.probability[i];
    if (std::ranges::any_of(points, [&](Point p) { return DistanceM(at, p) <= kNearM; }))
      near += belief.probability[i];
  }
  return all > 0 ? near / all : 0;
}

class LandmarkPage {
 public:
  LandmarkPage(const LandmarkStudy& study, const std::map<std::string, Blob>& results)
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
    LastBetas();
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
           std::string png, std::optional<bool> holds) {
    figures_.push_back({file, title, claim, measured, std::move(png), {}, holds});
  }

  // When a log's only robot made its n-th observation.
  static double ObservedAt(const Blob& log, int n) {
    return log.Get<double>("robot/0/observations/time_s")[static_cast<std::size_t>(n - 1)];
  }

  // The true place of a robot in the frame of a map of the first log.
  Point TruePlace(const Evaluation& map, const Blob& log, std::size_t robot, double time_s) const {
    const Track truth = ReadTrack(log, "truth/robot/" + std::to_string(robot) + "/poses/");
    const auto pose = PoseAt(truth, time_s);
    if (!pose) throw InputError("the log does not say where the robot truly is at an observation");
    return Inverse(map.alignment)(Point{pose->x_m, pose->y_m});
  }

  // With the landmarks of the map in which a robot was looked for.
  PanelPicture BeliefPanel(const std::string& title, const report::Grid& belief,
                           const std::string& stage) const {
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
    std::vector<double> spread_m;
    for (std::size_t n = 0; n < seen.size(); ++n) {
      const double distance_m = kStraightM * static_cast<double>(n + 1);
      PanelPicture panel =
          RawPanel(Say("(%c) after %.0f m", n == 0 ? 'a' : 'b', distance_m), Input("motion_log"), 0, seen[n]);
      panel.marks.clear();
      const report::Grid belief = beliefs.At(beliefs.StepAt(seen[n]));
      panel.density = belief;
      spread_m.push_back(SpreadM(belief));
      measured += Say("%s %.1f m after %.0f m", n == 0 ? ":" : ",", spread_m.back(), distance_m);
      panels.push_back(std::move(panel));
    }
    report::Box box = report::BoundsOf(panels);
    for (const PanelPicture& panel : panels) {
      PanelPicture alone;
      alone.density = panel.density;
      box = report::Around(box, report::BoundsOf({alone}));
    }
    Add("figure_01.png", "Figure 1: the model of motion",
        "Uncertainty accumulates while the robot moves as the line shows; its bent shape comes from errors "
        "of turns and of distances together.",
        measured + " (errors: 1.2 degrees per root metre, 3% of distances, 5% of turns).",
        report::DrawPanels(panels, box, 2), std::ranges::is_sorted(spread_m, std::less_equal<>()));
  }

  void Perception() {
    const BeliefView beliefs(Result("perception"), 0);
    const report::Grid belief = beliefs.At(0);
    double on_ring = 0, all = 0;
    for (std::size_t i = 0; i < belief.probability.size(); ++i) {
      const Point at = CentreOf(belief, i);
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
        "look alike: circles round both, and a residual elsewhere.",
        Say("%.0f%% of the probability lies within 1 m of the two circles of 5 m.", 100 * on_ring / all),
        report::DrawPanels({seen, map}, {-half, half, -8, 8}, 2), on_ring > 0.5 * all && on_ring < all);
  }

  // Localization of the reversed data in a map: panels of the belief after each of its first observations.
  struct BetaTables {
    std::vector<PanelPicture> panels;
    std::vector<double> there, spread_m;  // of each: the mass within kNearM of truth, and how wide it is
    int most_places = 0;                  // that hold a tenth of a table's mass each, in any of them
  };
  BetaTables BetasOf(const std::string& stage, const std::string& map, std::size_t count) const {
    const BeliefView beliefs(Result(stage), 0);
    const Evaluation score = Score(map, "first");
    const auto seen = Input("back").Get<double>("robot/0/observations/time_s");
    const auto forth = Input("first").Get<double>("robot/0/observations/time_s");
    BetaTables tables;
    for (std::size_t n = 0; n < std::min(count, seen.size()); ++n) {
      const report::Grid belief = beliefs.At(beliefs.StepAt(seen[n]));
      const Point truth = TruePlace(score, Input("first"), 0, forth[forth.size() - 1 - n]);
      tables.there.push_back(ShareWithin(belief, truth, kNearM));
      tables.spread_m.push_back(SpreadM(belief));
      tables.most_places = std::max(tables.most_places, PlacesWithShare(belief, 2 * kNearM, 0.1));
      PanelPicture panel = BeliefPanel(Say("t = %zu of %zu: %.0f%% within %.0f m of truth", forth.size() - n,
                                           forth.size(), 100 * tables.there.back(), kNearM),
                                       belief, map);
      panel.robot = truth;
      tables.panels.push_back(std::move(panel));
    }
    return tables;
  }

  void BetaEarly() {
    const BetaTables early = BetasOf("beta_early", IterationsStage(2), 9);
    Add("figure_03.png", "Figure 3: a sequence of beta tables",
        "Beta before the map has converged: the distributions are complex and multi-modal.",
        Say("beta with the observation of its own step, in the map of plain EM's second iteration: up to %d "
            "places %.0f m apart hold a tenth of a table each; the mass within %.0f m of truth goes from "
            "%.0f%% to %.0f%% in %zu observations.",
            early.most_places, 2 * kNearM, kNearM, 100 * early.there.front(), 100 * early.there.back(),
            early.there.size()),
        DrawFigure(early.panels, 3), early.most_places >= 2);
  }

  void RawData() {
    const Blob& log = Input("first");
    Add("figure_05.png", "Figure 5a: raw data",
        "2,972 controls; the final odometric error is about 24.9 m in a box of 90 by 90 m.",
        Say("%zu controls, %d observations, final odometric error %.1f m.",
            log.Get<double>("robot/0/odometry/time_s").size(), study_.observations,
            FinalOdometricErrorM(log, 0)),
        DrawFigure({RawPanel("raw odometry, observations", log)}, 1), {});
  }

  // As plain EM finds it, and beside it what the default search makes of the same log.
  void MostLikelyMap() {
    const Evaluation plain = Score(kEmMap, "first");
    PaperTable table{{"plain EM, iterations", "topology", "landmarks found", "spurious", "landmark error"},
                     {}};
    const auto row = [&](const std::string& name, const Evaluation& score) {
      const LandmarkScore& marks = *score.landmarks;
      table.rows.push_back({name, RightOrWrong(score),
                            Say("%lld of %lld", static_cast<long long>(marks.found),
                                static_cast<long long>(marks.found + marks.missed)),
                            Say("%lld", static_cast<long long>(marks.spurious)),
                            marks.rmse_m ? Say("%.2f m", *marks.rmse_m) : "-"});
    };
    std::vector<Evaluation> early;
    for (int n = 1; n <= kShownIterations; ++n) {
      early.push_back(Score(IterationsStage(n), "first"));
      row(std::to_string(n), early.back());
    }
    row(Say("until it settles (%lld)", static_cast<long long>(plain.iterations)), plain);
    row("default search", map_score_);
    Add("figure_06.png", "Figure 6a: the most likely map and path", "Topologically right.",
        "plain EM: " + ScoreText(plain) + ". The default search: " + ScoreText(map_score_) + ".",
        DrawFigure({RawPanel("raw odometry", Input("first")),
                    MapPanel("plain EM: map and most likely path", Result(kEmMap), Input("first"), plain)},
                   2),
        IsRight(plain));
    const auto from_on = [&](const auto& known) {
      std::size_t from = early.size();
      while (from > 0 && known(early[from - 1])) --from;
      return static_cast<int>(from) + 1;
    };
    const auto told = [](int from) {
      return from <= kShownIterations ? Say("from iteration %d on", from)
                                      : Say("not by %d", kShownIterations);
    };
    const int right = from_on(IsRight);
    const int all = from_on([](const Evaluation& score) {
      return IsRight(score) && score.landmarks->missed == 0 && score.landmarks->spurious == 0;
    });
    Add("", "Section 6: the topology after two iterations",
        "The principle topology of the environment was already known after two iterations.",
        "every association right " + told(right) + ".", "", right <= 2);
    figures_.back().table = std::move(table);
    Add("", "Section 6: the landmarks after four iterations",
        "After approximately four iterations the location of the landmarks was known with high certainty.",
        "every landmark within 3 m, and no other, " + told(all) + ".", "", all <= 4);
  }

  // Raw data and map of a prefix; the belief of its last step beneath.
  std::string PrefixPicture(int n, const Evaluation& score) const {
    const Blob& result = Result(n == study_.observations ? kEmMap : PrefixStage(n));
    const double until_s = ObservedAt(Input("first"), n);
    const BeliefView beliefs(result, 0);
    PanelPicture map = MapPanel(Say("map after observation %d: topology %s", n, RightOrWrong(score)), result,
                                Input("first"), score);
    map.density = beliefs.At(beliefs.StepAt(until_s));
    map.density_name = "belief of the last step";
    return DrawFigure({RawPanel(Say("raw data up to observation %d", n), Input("first"), 0, until_s), map},
                      2);
  }

  Evaluation PrefixScore(int n) const {
    return Score(n == study_.observations ? kEmMap : PrefixStage(n), "first");
  }

  // The drive backwards, which closes a small cycle first; odometry alone is laid over truth as well as it
  // goes.
  void FirstRevisit() {
    if (study_.revisit == 0) return;
    const Blob &log = Input("back"), &result = Result("small_cycle");
    const Evaluation score = Score("small_cycle", "back");
    const double until_s = ObservedAt(log, study_.revisit);
    const double odometry_m = OdometryRmseM(log, 0, until_s);
    Add("figure_07.png", "Figure 7: the first landmark seen again",
        "Even where a small cycle brings but little odometric error, the map gets better.",
        Say("the first robot's drive backwards, up to observation %d, which closes a cycle of %.0f m: ",
            study_.revisit, study_.revisit_m) +
            ScoreText(score) + Say("; path by odometry alone %.2f m.", odometry_m),
        DrawFigure({RawPanel("raw data", log, 0, until_s), MapPanel("map and path", result, log, score)}, 2),
        IsRight(score) && score.trajectory_rmse_m < odometry_m);
  }

  // The observation that closes the large cycle, the one before it, and those of the paper's claims after.
  void Prefixes() {
    const int first = std::max(2, study_.closing - 2);
    std::map<int, Evaluation> scores;
    int settled = study_.observations + 1;  // right from there on
    for (int n = first; n <= study_.observations; ++n) scores[n] = PrefixScore(n);
    while (settled > first && IsRight(scores.at(settled - 1))) --settled;
    std::string table =
        Say(" The large cycle closes with observation %d. Topology by prefix:", study_.closing);
    for (const auto& [n, score] : scores) table += Say(" %d %s,", n, RightOrWrong(score));
    table.back() = ';';
    table += settled <= study_.observations ? Say(" right from %d on.", settled) : " not right at the end.";
    const int turn = std::clamp(settled, first + 2, study_.observations);
    const struct {
      int prefix;
      const char *file, *title, *claim;
      bool right;
    } shown[] = {
        {turn - 2, "figure_08.png", "Figure 8: two observations earlier",
         "After 15 landmarks the most plausible map is topologically wrong.", false},
        {turn - 1, "figure_09.png", "Figure 9: an observation earlier", "After 16 it is still wrong.", false},
        {turn, "figure_10.png", "Figure 10: the cycle is closed, the topology right",
         "After 17 the topology is right; from this point on it always is.", true},
        {std::min(turn + 3, study_.observations), "figure_11.png", "Figure 11: three observations later",
         "After 20 it is right.", true}};
    for (const auto& [prefix, file, title, claim, right] : shown) {
      const Evaluation& score = scores.at(prefix);
      Add(file, title, claim,
          Say("after observation %d: ", prefix) + ScoreText(score) + "." + (prefix == turn ? table : ""),
          PrefixPicture(prefix, score), IsRight(score) == right);
    }
    const BeliefView beliefs(Result(PrefixStage(turn - 2)), 0);
    const int places =
        PlacesWithShare(beliefs.At(beliefs.StepAt(ObservedAt(Input("first"), turn - 2))), 2 * kNearM, 0.01);
    Add("", "Figure 8: where the robot may be at the last step",
        "The approach assigns high probability to several locations for the last step.",
        Say("after observation %d, once EM has settled, the belief of the last step has a hundredth of "
            "its mass or more at %d %s (told apart from %.0f m on).",
            turn - 2, places, places == 1 ? "place" : "places", 2 * kNearM),
        "", places >= 2);
  }

  void SecondWorld() {
    const Blob& log = Input("other");
    const Evaluation score = Score("other_map", "other");
    Add("figure_12_13.png", "Figures 12 and 13: a second dataset",
        "Raw data of another part of the building (2,091 controls), and the most likely map with the path. "
        "Of the map the paper gives no figures: checked is whether its topology is right.",
        Say("%zu controls, final odometric error %.1f m; ", log.Get<double>("robot/0/odometry/time_s").size(),
            FinalOdometricErrorM(log, 0)) +
            ScoreText(score) + ".",
        DrawFigure({RawPanel("raw data", log),
                    MapPanel("map and most likely path", Result("other_map"), log, score)},
                   2),
        IsRight(score));
  }

  void LastBetas() {
    BetaTables last = BetasOf("beta", kEmMap, 5);
    std::string measured = Say("mass within %.0f m of truth after 1, 2, ... observations:", kNearM);
    for (const double share : last.there) measured += Say(" %.0f%%", 100 * share);
    measured += "; standard deviation of the position:";
    for (const double spread_m : last.spread_m) measured += Say(" %.1f", spread_m);
    last.panels.insert(last.panels.begin(), UniformPanel(last.panels));
    Add("figure_14.png", "Figure 14: the last beta tables after convergence",
        "The last beta is uniform; with every step the uncertainty shrinks; after three steps the place is "
        "known with high certainty.",
        measured +
            " m. Beta is computed as what it is: localization of the reversed data in the map, the "
            "observation of its own step included.",
        DrawFigure(last.panels, 3),
        last.there.at(3) > 0.9 && std::ranges::is_sorted(last.spread_m, std::greater<>()));
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
                   2),
        IsRight(joint));
    const BeliefView beliefs(Result("alpha"), 0);
    const Evaluation em_map = Score(kEmMap, "first");
    const auto seen = log.Get<double>("robot/0/observations/time_s");
    std::vector<PanelPicture> panels;
    std::string measured = Say("mass within %.0f m of truth after 1, 2, ... observations:", kNearM);
    double first = 0, at_landmarks = 0, known = 0;  // after one observation, and after four
    for (std::size_t n = 0; n < std::min<std::size_t>(6, seen.size()); ++n) {
      const report::Grid belief = beliefs.At(beliefs.StepAt(seen[n]));
      const Point truth = TruePlace(em_map, log, 0, seen[n]);
      const double there = ShareWithin(belief, truth, kNearM);
      measured += Say(" %.0f%%", 100 * there);
      PanelPicture panel = BeliefPanel(
          Say("(c%zu) alpha(%zu): %.0f%% within %.0f m of truth", n + 1, n + 1, 100 * there, kNearM), belief,
          kEmMap);
      if (n == 0) first = there;
      if (n == 0) at_landmarks = ShareNear(belief, panel.landmarks);
      if (n == 3) known = there;
      panel.robot = truth;
      panels.push_back(std::move(panel));
    }
    measured +=
        Say("; after the first %.0f%% is within %.0f m of a landmark of the map", 100 * at_landmarks, kNearM);
    Add("figure_18c.png", "Figure 18c: the second robot's first alpha tables",
        "After one observation it may be at any landmark of the map; after four steps it knows where it is.",
        measured + ".", DrawFigure(panels, 3), at_landmarks > 0.5 && first < 0.5 && known > 0.9);
  }

  void ForwardOnly() {
    const Evaluation forward = Score("forward", "first");
    Add("forward_only.png", "Section 6: without revising the past",
        "Any incremental routine that does not revise past location estimates would be bound to fail in such "
        "a situation (conjectured).",
        "one pass, each observation looked at once: " + ScoreText(forward) +
            ". EM, alpha and beta: " + ScoreText(map_score_) + ".",
        DrawFigure(
            {MapPanel("one pass, nothing revised", Result("forward"), Input("first"), forward),
             MapPanel("with the past revised (alpha beta)", Result("map"), Input("first"), map_score_)},
            2),
        !IsRight(forward));
  }

  const LandmarkStudy& study_;
  const std::map<std::string, Blob>& results_;
  Evaluation map_score_;
  std::vector<PaperFigure> figures_;
};

}  // namespace

std::vector<PaperFigure> LandmarkFigures(const LandmarkStudy& study,
                                         const std::map<std::string, Blob>& results) {
  return LandmarkPage(study, results).Make();
}

}  // namespace cairn::datasets
