#include "schema/wire/allow_list.h"
#include "schema/wire/keys.h"
#include "tests/fuzz/scratch.h"
#include "tests/fuzz/targets.h"

namespace cairn::fuzz {
namespace {

// A pair of no importance, always the same.
constexpr std::string_view kPublic = "Yne@$w-vo<fVvi]a<NY6T1ed:M$fCG*[IaLV{hID";
constexpr std::string_view kSecret = "D:)Q[IlAW!ahhC2ac:9*A}h:p?([4%wOTJ%JR%cs";

Outcome Run(std::span<const std::uint8_t> bytes) {
  const MemoryFile file(AsText(bytes));
  const Result<wire::KeyPair> pair = wire::ReadKeyPair(file.path());
  const Result<std::string> key = wire::ReadPublicKey(file.path());
  const auto allowed = wire::ReadAllowList(file.path());
  if (pair.ok()) CAIRN_DEMAND(pair.value().public_key.size() == 40, "a key of another length");
  if (key.ok()) CAIRN_DEMAND(key.value().size() == 40, "a key of another length");
  return pair.ok() || key.ok() || allowed.ok() ? Outcome::kAccepted : Outcome::kRefused;
}

std::vector<Bytes> Seeds() {
  const std::string pub(kPublic), secret(kSecret);
  std::vector<Bytes> seeds;
  for (const std::string& text :
       {pub + "\n", "# both\n" + pub + " public\n" + secret + " secret\n",
        "# a list\n\n" + pub + " worker,viewer desk\n" + secret + "  submitter\r\nend\r\n"})
    seeds.emplace_back(text.begin(), text.end());
  return seeds;
}

}  // namespace

Target KeysTarget() { return {"keys", Run, Seeds, 5000}; }

}  // namespace cairn::fuzz
