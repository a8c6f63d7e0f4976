#include "pipelines/pipeline.h"

#include <algorithm>

#include "schema/blob_part.h"
#include "schema/step_limits.h"

namespace cairn {

std::string Step::Share(Blob blob) {
  auto shared = std::make_shared<const Blob>(std::move(blob));
  const std::string hash = shared->ContentHash().Binary();
  blobs.push_back(std::move(shared));
  return hash;
}

BlobPtr Inputs::GetHead(const std::string& name, const std::string& but) const {
  const Result<BlobPtr> head = CutPart(*Get(name), HeadPart(but));
  CAIRN_DEMAND(head.ok(), head.status().message());
  return head.value();
}

void ExpectRounds(double rounds, double cost, double width, proto::Step* plan, double least, double most) {
  if (!(rounds > 0)) return;
  proto::Phase& phase = *plan->add_later();
  phase.set_rounds(rounds);
  phase.set_cost(std::min(cost, kMostAmount));
  phase.set_width(width);
  if (least == 1 && most == 1) return;
  phase.set_least(least);
  phase.set_most(most);
}

double RoundsLater(const proto::Step& plan) {
  double rounds = 0;
  for (const proto::Phase& phase : plan.later()) rounds += phase.rounds();
  return rounds;
}

double CostLater(const proto::Step& plan) {
  double cost = 0;
  for (const proto::Phase& phase : plan.later()) cost += phase.cost();
  return cost;
}

}  // namespace cairn
