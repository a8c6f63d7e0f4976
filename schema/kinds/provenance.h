// schema/FORMAT.md, `provenance/`: how a file of any kind came about.
#pragma once

#include "schema/kinds/fields.h"

namespace cairn::kinds {

struct Provenance {
  struct Rounds {
    Texts note;
    Column<std::int64_t> rounds, tasks;
    Column<double> seconds_s, compute_s;
    static void Fields(const auto& field) {
      field(Needed("note", "M"), &Rounds::note);
      field({"rounds", "M", From(0)}, &Rounds::rounds);
      field(Needed("tasks", "M", From(0)), &Rounds::tasks);
      field(Needed("seconds_s", "M", From(0)), &Rounds::seconds_s);
      field(Needed("compute_s", "M", From(0)), &Rounds::compute_s);
    }
  };

  Column<double> seconds_s;
  Texts job_yaml, stage, version, kind, build, finished_utc, hosts;
  Column<std::uint8_t> job;
  Column<std::int64_t> workers, retries;
  Rounds round;

  static Provenance In(const Blob& blob) { return FieldsIn<Provenance>("provenance/", blob); }
  static void Fields(const auto& field) {
    field({"seconds_s", "", From(0)}, &Provenance::seconds_s);
    field({"job_yaml", ""}, &Provenance::job_yaml);
    field({"job", "B", Free()}, &Provenance::job);
    field({"stage", ""}, &Provenance::stage);
    field({"version", ""}, &Provenance::version);
    field({"workers", "", From(0)}, &Provenance::workers);
    field("round", &Provenance::round);
    field({"kind", ""}, &Provenance::kind);
    field({"build", ""}, &Provenance::build);
    field({"finished_utc", ""}, &Provenance::finished_utc);
    field({"hosts", "H"}, &Provenance::hosts);
    field({"retries", "", From(0)}, &Provenance::retries);
  }
};

}  // namespace cairn::kinds
