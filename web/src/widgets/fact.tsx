// One line of a list of figures (<dl class="numbers">).
import type { ComponentChildren } from "preact";

export function Fact({ name, children, title, problem }: { name: string; children: ComponentChildren; title?: string; problem?: boolean }) {
  return (
    <div class={problem ? "problem" : undefined}>
      <dt>{name}</dt>
      <dd title={title}>{children}</dd>
    </div>
  );
}
