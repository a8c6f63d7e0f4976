// Finding a trace on another one when little is known of where: loops, and recovery from large errors, which
// [DM98] leaves to be done by hand (section 4.3).
#pragma once

#include <vector>

#include "pipelines/local_map/traces/match.h"

namespace cairn::local_map {

struct FindOptions {
  ScoreOptions score = WideScore();
  double step_m = 0.06;         // of u
  double sharpness = 0.2;       // nats a unit of summed similarity, for the confidence,
  double peak_sharpness = 0.4;  // and for how broad a peak is
  double null_score = 1.3;      // similarity a comparable side that places which have nothing in common reach
  double floor_sd_m = 0.015;    // added in squares: what no match resolves
  double apart_m = 0.5;         // candidates nearer than that are one
  int min_known = 8;            // sides that must be comparable
  int max_candidates = 3;

  // Averages: what differs little between two places is all that tells them apart, and trimming drops it.
  // Edges across the way are seen in whole cells.
  static ScoreOptions WideScore() {
    ScoreOptions score;
    score.scheme = Scheme::kAverage;
    score.similarity.cross_sigma_m = 0.1;
    score.cross_weight = 2;
    return score;
  }
};

// Where the other trace lies on the recorded one.
struct Candidate {
  double z_m = 0, u_m = 0;        // its origin in the recorded trace's frame
  double sd_z_m = 0, sd_u_m = 0;  // infinite: not determined
  double score = 0;               // summed similarities of edges, of edges across the way, and of sides
  double sides = 0;               // the sides similarity a comparable side
  int known = 0;                  // sides that could be compared
  // Probability that it lies there, against all other positions in the range and against none of them: small
  // where the second-best peak is as good, and where little fits.
  double confidence = 0;
  // The same of its z whatever its u, and of its u whatever its z: a blank corridor tells u alone.
  double confidence_z = 0, confidence_u = 0;
  static void Fields(const auto& field) {
    field("z_m", &Candidate::z_m);
    field("u_m", &Candidate::u_m);
    field("sd_z_m", &Candidate::sd_z_m);
    field("sd_u_m", &Candidate::sd_u_m);
    field("score", &Candidate::score);
    field("sides", &Candidate::sides);
    field("known", &Candidate::known);
    field("confidence", &Candidate::confidence);
    field("confidence_z", &Candidate::confidence_z);
    field("confidence_u", &Candidate::confidence_u);
  }
};

// `other` runs the same way (Reversed, if not); its origin is sought in `range` about `at`. The best comes
// first; empty where too little can be compared. `other` has kMaxFeatures at most. Costs (range.z / cell)
// (range.u / step) features.
std::vector<Candidate> FindOn(const EdgeTrace& recorded, const EdgeTrace& other, const Position& at,
                              const SearchWindow& range, const FindOptions& options);

}  // namespace cairn::local_map
