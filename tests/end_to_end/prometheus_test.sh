#!/usr/bin/env bash
# A real Prometheus scrapes a real coordinator: what it reads is what is there, its own tools find nothing wrong with page,
# alerts and dashboard, and an alert is raised once there is reason to.
source "$(dirname "$0")/common.sh"
command -v prometheus >/dev/null || skip "prometheus is not installed"
command -v promtool >/dev/null || skip "promtool is not installed"
cp "$CAIRN_SOURCE"/deploy/monitoring/* .

exits 0 promtool check rules rules.yml
exits 0 promtool test rules rules_test.yml
cairn coordinator --metrics 127.0.0.1:0 --store-gb 1 2>coordinator.log &
coordinator=$!
until_true 10 grep -q 'listening on' coordinator.log
where=$(sed -n 's|.*http://\(.*\)/metrics.*|\1|p' coordinator.log)
simulate log.h5
exits 0 cairn submit landmark_map log.h5 --set iterations=2
cairn worker 2>worker.log &
exits 0 cairn watch

page() { (exec 3<>"/dev/tcp/${where/://}" && printf 'GET /metrics HTTP/1.1\r\nHost: here\r\n\r\n' >&3 && cat <&3) | sed '1,/^\r$/d'; }
page >page
grep -q '^cairn_jobs' page || die "no metrics: $(cat page)"
exits 0 promtool check metrics <page
[ ! -s stderr ] && [ ! -s stdout ] || die "promtool finds fault with the page: $(cat stdout stderr)"

cat >prometheus.yml <<END
global: {scrape_interval: 1s, evaluation_interval: 1s}
rule_files: [rules.yml]
scrape_configs:
  - {job_name: cairn, static_configs: [{targets: ['$where']}]}
END
sed -i 's/for: .*m$/for: 0s/' rules.yml  # who waits here should not wait minutes
exits 0 promtool check config prometheus.yml
prometheus --config.file prometheus.yml --storage.tsdb.path data --web.listen-address 127.0.0.1:0 2>prometheus.log &
until_true 20 grep -q 'msg="Listening on"' prometheus.log
server=http://$(sed -n 's/.*msg="Listening on" address=//p' prometheus.log)
# asks EXPRESSION: what it knows of that, a line a series: {labels} => value @[time]
asks() { promtool query instant "$server" "$1" >asked 2>&1 || die "it cannot be asked '$1': $(cat asked)"; }
knows() { asks "$1" && grep -q -- "=> $2 @" asked; }
until_true 20 knows 'up{job="cairn"}' 1
until_true 20 knows 'cairn_jobs{state="done"}' 1
knows 'cairn_store_limit_bytes' 1000000000 || die "not the limit: $(cat asked)"
knows 'count({__name__=~"cairn_.*"}) > 50' '[0-9]*' || die "it reads too little: $(cat asked)"
shown=0
while IFS= read -r expression; do
  expression=${expression//\\\"/\"}
  expression=${expression//\$__rate_interval/1m}
  asks "${expression//\$instance/.*}"
  shown=$((shown + 1))
done < <(grep -oE '"expr": "([^"\\]|\\.)*"' dashboard.json | sed 's/^"expr": "//; s/"$//')
[ $shown -ge 20 ] || die "only $shown expressions of the dashboard were asked"

firing() { knows "ALERTS{alertname=\"$1\", alertstate=\"firing\"}" 1; }
! firing CairnNoWorkers || die "an alert without reason"
kill -9 "$(jobs -p 'cairn worker')"
exits 0 cairn submit landmark_map log.h5 --seed 2
until_true 60 firing CairnNoWorkers
kill -9 "$coordinator"
until_true 60 firing CairnDown
