#!/usr/bin/env bash
# Job files made to do harm: refused with their line, within a bound on time and memory; the service goes on.
source "$(dirname "$0")/common.sh"

simulate log.h5
ulimit -v 4000000 # kB, so that a bomb that goes off ends here
job() { printf '%s\n' 'inputs: {log: log.h5}' 'stages:' "$@" >job.yaml; }
stage() { job "  - {name: a, pipeline: landmark_map, log: log, options: {$1}}"; }
refuses_job() { refuses "$1" timeout 60 cairn run job.yaml --out out; }

# Values.
for value in 9223372036854775808 -9223372036854775808 18446744073709551616 1e308 -1 .nan .inf 0x7fffffffffffffff; do
  stage "iterations: $value"
  refuses_job 'job.yaml:3: iterations: '
done
stage 'cell_m: 1e-9'
refuses_job 'cell_m|memory|cells'
rm -rf out # that one was refused by its worker
stage 'cell_m: -0.25'
refuses_job 'job.yaml:3: cell_m: '
stage "cell_m: $(head -c 100000 /dev/zero | tr '\0' 9)"
refuses_job 'job.yaml:3: cell_m: '
printf '%s\n' 'seed: -1' 'inputs: {log: log.h5}' 'stages:' '  - {name: a, pipeline: landmark_map, log: log}' >job.yaml
refuses_job 'job.yaml:1: seed'

# Names that would be paths.
for name in ../up /etc/passwd .. a/b .hidden "$(head -c 70 /dev/zero | tr '\0' x)"; do
  job "  - {name: '$name', pipeline: landmark_map, log: log}"
  refuses_job 'job.yaml:3: .*no name'
done

# Names of what a run writes itself.
for name in map.png picture.png report.html a.h5; do
  job '  - {name: a, pipeline: landmark_map, log: log}' "  - {name: '$name', pipeline: landmark_map, log: log}"
  refuses_job "job.yaml:4: stage '$name' has the name of a file that a run writes"
done
[ ! -e out ] || die "a job that was refused made its folder"

# Bombs: aliases of aliases, deep nesting, very many stages, one very long line.
{
  printf 'a: &a [x, x, x, x, x, x, x, x, x]\n'
  previous=a
  for next in b c d e f g h i j k l m n; do
    printf '%s: &%s [*%s, *%s, *%s, *%s, *%s, *%s, *%s, *%s, *%s]\n' $next $next $previous $previous $previous $previous \
      $previous $previous $previous $previous $previous
    previous=$next
  done
  printf 'inputs: {log: *n}\nstages: *n\n'
} >job.yaml
refuses_job 'job.yaml:[0-9]+: (unknown key|more than [0-9]+ aliases)'
printf '%s\n' 'inputs: &a {log: log.h5, more: *a}' 'stages: []' >job.yaml
refuses_job 'job.yaml:'
for open in '[' '{a: ' '- ' '? '; do
  { printf 'inputs: {log: log.h5}\nstages: '; for _ in $(seq 20000); do printf '%s' "$open"; done; } >job.yaml
  refuses_job 'job.yaml:'
done
{ printf 'inputs: {log: log.h5}\nstages:\n'; for _ in $(seq 5000); do printf '  - *s\n'; done; } >job.yaml
refuses_job 'job.yaml:'
{ printf 'inputs: {log: log.h5}\nname: '; head -c 2000000 /dev/zero | tr '\0' x; } >job.yaml
refuses_job 'larger than 1 MB'
printf 'name: \xff\xfe\n\x00inputs: {}\n' >job.yaml
refuses_job 'job.yaml'

# A service that got all this is as well as before.
cairn coordinator >coordinator.log 2>&1 &
until_true 20 cairn list >/dev/null
cairn worker >worker.log 2>&1 &
stage 'iterations: 9223372036854775808'
refuses 'job.yaml:3: iterations: ' cairn submit job.yaml
stage 'iterations: 2'
exits 0 cairn submit job.yaml
exits 0 cairn watch "$(sed 's/submitted \([^;]*\);.*/\1/' stdout)"
