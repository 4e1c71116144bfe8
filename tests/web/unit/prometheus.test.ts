// The status panel reads what the server writes for GET /metrics.
import assert from "node:assert/strict";
import test from "node:test";
import { buckets, label_values, parse_metrics, quantile, since, total } from "@page/panels/prometheus";

const text = `# HELP teracell_build_info The version that runs.
# TYPE teracell_build_info gauge
teracell_build_info{version="0.1.0"} 1
teracell_requests_total{route="tile_bin",status="200"} 41
teracell_requests_total{route="tile_bin",status="304"} 1
teracell_requests_total{route="info",status="200"} 2
h_bucket{route="tile_bin",le="0.001"} 10
h_bucket{route="tile_bin",le="0.003"} 30
h_bucket{route="tile_bin",le="+Inf"} 42
h_bucket{route="info",le="0.001"} 2
h_bucket{route="info",le="0.003"} 2
h_bucket{route="info",le="+Inf"} 2
h_bucket{route="metrics",le="0.001"} 1000
h_sum{route="tile_bin"} 0.25
cache_bytes{cache="chunks"} 1.5e+06
cache_bytes{cache="say \\"x\\"\\n"} 7
process_resident_memory_bytes 44040192

not a line of it
`;
const samples = parse_metrics(text);

test("names, labels and numbers are read; comments and nonsense are passed over", () => {
  assert.deepEqual(samples[0], { name: "teracell_build_info", labels: { version: "0.1.0" }, value: 1 });
  assert.deepEqual(samples.at(-1), { name: "process_resident_memory_bytes", labels: {}, value: 44040192 });
  assert.equal(total(samples, "cache_bytes", { cache: "chunks" }), 1.5e6);
  assert.deepEqual(label_values(samples, "cache_bytes", "cache"), ["chunks", 'say "x"\n']);
});

test("samples are summed by name and labels", () => {
  assert.equal(total(samples, "teracell_requests_total"), 44);
  assert.equal(total(samples, "teracell_requests_total", { route: "tile_bin" }), 42);
  assert.equal(total(samples, "nothing"), 0);
});

test("buckets hold counts of their own, without the routes that only watch the server", () => {
  assert.deepEqual(buckets(samples, "h"), [{ le: 0.001, count: 12 }, { le: 0.003, count: 20 }, { le: Infinity, count: 12 }]);
});

test("a quantile is given as the bucket that it lies in", () => {
  const all = buckets(samples, "h");
  assert.deepEqual(quantile(all, 0.25), { from: 0, to: 0.001 });
  assert.deepEqual(quantile(all, 0.5), { from: 0.001, to: 0.003 });
  assert.deepEqual(quantile(all, 0.95), { from: 0.003, to: Infinity });
  assert.equal(quantile(since(all, all), 0.5), null);
});

test("what came since is the difference, even after the server was restarted", () => {
  const before = [{ le: 0.001, count: 10 }, { le: 0.003, count: 25 }];
  assert.deepEqual(since(buckets(samples, "h"), before), [{ le: 0.001, count: 2 }, { le: 0.003, count: 0 }, { le: Infinity, count: 12 }]);
});
