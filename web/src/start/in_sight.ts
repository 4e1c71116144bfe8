// Whether an element has been in sight, or nearly. What is listed further down need not be fetched before.
import { type RefObject } from "preact";
import { useEffect, useState } from "preact/hooks";

export function use_seen(element: RefObject<HTMLElement>): boolean {
  const [seen, set_seen] = useState(false);
  useEffect(() => {
    const observer = new IntersectionObserver(
      (entries) => {
        if (!entries.some((entry) => entry.isIntersecting)) return;
        set_seen(true);
        observer.disconnect();
      },
      { rootMargin: "300px" },
    );
    observer.observe(element.current!);
    return () => observer.disconnect();
  }, []);
  return seen;
}
