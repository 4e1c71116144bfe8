// The connection, how long answers take (here and on the server), and what is kept in memory. The figures are fetched
// every two seconds while the panel is shown.
import { useEffect, useState } from "preact/hooks";
import { bytes_text, clock, grouped, milliseconds, percent, plural } from "../base/format";
import { words_of } from "../base/messages";
import { quoted } from "../base/shell";
import { get } from "../server/api";
import { connection } from "../server/connection";
import type { Viewer } from "../state/viewer";
import { CodeLine } from "../widgets/copy";
import { Fact } from "../widgets/fact";
import { type Bucket, type Sample, buckets, label_values, parse_metrics, quantile, since, total } from "./prometheus";
import { Sparkline } from "./sparkline";

const EVERY = 2000;
const KEPT = 60; // values of a curve: two minutes
const HISTOGRAM = "teracell_request_duration_seconds";

interface Moment {
  at: number;
  samples: Sample[];
  answer: number; // milliseconds, of /metrics itself as seen from here
}

async function moment(signal: AbortSignal): Promise<Moment> {
  const began = performance.now();
  const response = await get("metrics", { signal, priority: "low" });
  const answer = performance.now() - began;
  return { at: Date.now(), samples: parse_metrics(await response.text()), answer };
}

// The moments of the last two minutes, oldest first.
function use_moments(): { moments: readonly Moment[]; error: string | null } {
  const [moments, set_moments] = useState<readonly Moment[]>([]);
  const [error, set_error] = useState<string | null>(null);
  useEffect(() => {
    const abort = new AbortController();
    const ask = async () => {
      if (document.visibilityState !== "visible") return;
      try {
        const next = await moment(abort.signal);
        set_moments((list) => [...list.slice(1 - KEPT), next]);
        set_error(null);
      } catch (problem) {
        if (!abort.signal.aborted) set_error(words_of(problem));
      }
    };
    void ask();
    const timer = setInterval(() => void ask(), EVERY);
    return () => {
      clearInterval(timer);
      abort.abort();
    };
  }, []);
  return { moments, error };
}

const median = (list: readonly number[], q = 0.5): number =>
  [...list].sort((a, b) => a - b)[Math.min(list.length - 1, Math.floor(q * list.length))] ?? NaN;

function Curve({ label, value, values, title }: { label: string; value: string; values: readonly number[]; title?: string }) {
  return (
    <div class="curve" title={title}>
      <span class="curve-label">{label}</span>
      <Sparkline values={values} length={KEPT} label={`${label}, the last two minutes`} />
      <span class="curve-value">{value}</span>
    </div>
  );
}

const bound = (seconds: number) => (Number.isFinite(seconds) ? milliseconds(1000 * seconds) : "more");
const range = (r: { from: number; to: number } | null) => (r ? (Number.isFinite(r.to) ? `≤ ${bound(r.to)}` : `> ${bound(r.from)}`) : "–");

function Server({ moments }: { moments: readonly Moment[] }) {
  const now = moments.at(-1)!;
  const work = (m: Moment): Bucket[] => buckets(m.samples, HISTOGRAM);
  const answered = (m: Moment) => work(m).reduce((n, b) => n + b.count, 0);
  const rates = moments.slice(1).map((m, n) => Math.max(0, (1000 * (answered(m) - answered(moments[n]!))) / (m.at - moments[n]!.at)));
  const times = moments.length > 1 && answered(now) > answered(moments[0]!) ? since(work(now), work(moments[0]!)) : work(now);
  const memory = moments.map((m) => total(m.samples, "process_resident_memory_bytes"));
  const caches = label_values(now.samples, "teracell_cache_bytes", "cache");
  const one = (name: string) => total(now.samples, name);
  return (
    <>
      <section>
        <h3>Server</h3>
        <Curve label="answers per second" value={grouped((rates.at(-1) ?? 0).toFixed(0))} values={rates} />
        <Curve label="memory" value={bytes_text(memory.at(-1)!)} values={memory} title="Resident memory of the server" />
        <dl class="numbers">
          <Fact name="time per answer, median">{range(quantile(times, 0.5))}</Fact>
          <Fact name="95th percentile">{range(quantile(times, 0.95))}</Fact>
          <Fact name="answers so far">{grouped(answered(now))}</Fact>
          <Fact name="connections">
            {grouped(one("teracell_connections"))}, {plural(one("teracell_waiting_requests"), "request")} in progress
          </Fact>
          <Fact name="read from files">
            {bytes_text(one("teracell_read_bytes_total"))} in {plural(one("teracell_reads_total"), "read")}
          </Fact>
          {one("teracell_overloaded_total") > 0 && <Fact name="refused because busy">{grouped(one("teracell_overloaded_total"))}</Fact>}
          {one("teracell_damaged_total") > 0 && (
            <Fact name="damaged data found" problem>
              {grouped(one("teracell_damaged_total"))}
            </Fact>
          )}
        </dl>
      </section>
      <section>
        <h3>Caches of the server</h3>
        {caches.map((cache) => {
          const value = (name: string) => total(now.samples, `teracell_cache_${name}`, { cache });
          const [held, limit, hits, misses] = [value("bytes"), value("limit_bytes"), value("hits_total"), value("misses_total")];
          return (
            <div class="cache" key={cache}>
              <span class="cache-name">{cache}</span>
              <span>{hits + misses > 0 ? `${percent(hits / (hits + misses))} hits` : "not used yet"}</span>
              <span class="faint">
                {bytes_text(held)} of {bytes_text(limit)}
              </span>
              <meter min={0} max={limit} value={held} aria-label={`Memory of the cache of ${cache}`} />
            </div>
          );
        })}
      </section>
    </>
  );
}

export function StatusPanel({ viewer }: { viewer: Viewer }) {
  const { moments, error } = use_moments();
  const { state, since: time } = connection.value;
  const { tiles } = viewer;
  const latencies = tiles.latencies.value;
  const version = moments.at(-1)?.samples.find((s) => s.name === "teracell_build_info")?.labels.version;
  return (
    <>
      <p class={`care ${state === "there" ? "fine" : "bad"}`}>
        <span class={`lamp ${state}`} />
        <span>
          {state === "there" ? "The server answers" : `The server has not answered since ${clock(time)}`}
          {version && state === "there" ? `. It runs teracell ${version}` : ""}.
        </span>
      </p>
      <section>
        <h3>This page</h3>
        <Curve
          label="time per tile"
          value={latencies.length ? milliseconds(latencies.at(-1)!) : "–"}
          values={latencies.slice(-KEPT)}
          title="From the request for a tile to its last byte"
        />
        <Curve
          label="time per request"
          value={moments.length ? milliseconds(moments.at(-1)!.answer) : "–"}
          values={moments.map((m) => m.answer)}
          title="The time that a small request takes, as seen from here"
        />
        <dl class="numbers">
          <Fact name="median, 95th percentile">
            {latencies.length ? `${milliseconds(median(latencies))}, ${milliseconds(median(latencies, 0.95))}` : "–"}
          </Fact>
          <Fact name="tiles requested">
            {tiles.in_flight.value} now, {tiles.waiting.value} waiting
          </Fact>
          <Fact name="kept in memory">
            {plural(tiles.tiles.value, "tile")}, {bytes_text(tiles.bytes.value)}
          </Fact>
          {tiles.failed.value > 0 && <Fact name="failed, to be tried again">{grouped(tiles.failed.value)}</Fact>}
          {tiles.damaged.value > 0 && (
            <Fact name="damaged" problem>
              {plural(tiles.damaged.value, "tile")}
            </Fact>
          )}
        </dl>
      </section>
      <section>
        <h3>The file</h3>
        <p class="note">Damage is found in what is read. This command reads every byte, on the machine that has the file:</p>
        <CodeLine class="code-line" text={`teracell verify ${quoted(`${viewer.info.id}.tcell`)}`} what="the command that reads every byte" />
      </section>
      {error && <p class="problem">The server's figures can't be read: {error}</p>}
      {moments.length > 0 && <Server moments={moments} />}
    </>
  );
}
