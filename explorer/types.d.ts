// What the engine is asked and what it answers, as in `engine/src/request.rs` and `answer.rs`.

/** A change of a distribution: another family; another width; what is dragged on its curve; a node of a polygon that is added or removed; the weight of a part of a mixture, its last part in two halves, or one part less. */
type LawChange = {
  family?: string; width?: number; move?: { handle: number; stretch: number; density: number }; add?: number | null; remove?: number;
  weight?: { part: number; weight: number }; split?: null; remove_part?: number;
};
/** A key of the scenario, and its new value as TOML or what changes in the distribution that is there. */
type Change = { key: string; value?: string | null; slip?: string; law?: LawChange };
type Part = "force" | "stretches" | "critical_stiffness" | "block" | "task";
type EngineRequest = { text: string; changes: Change[]; parts: Part[]; position: number; preview: boolean; view?: View };
/** Widths of a picture, and of one that is as wide as all of them; whether readings are shown. */
type View = { width: number; whole: number; readings: boolean };

/** What scripts read of an answer; columns of numbers have the paths of the rest. */
type Answer = {
  text: string; view?: Shown; failures?: string[]; invalid?: { message: string; help: string | null; line: number | null };
  force?: { position: number[] }; stretches?: { position: number };
};

/** What the page shows: `details` can be asked for; rows of numbers are in HTML; `length` is the unit. */
type Shown = {
  sheet: string; details: Part[]; controls: Row[]; panels: Panel[]; numbers: [name: string, value: string][]; length: string;
};
/** A row of controls. */
type Row = { group: string; id: string; class: string; label: string; items: Item[] };
/** A control, with its change in JSON. */
type Item = {
  kind: "range" | "number" | "select" | "button"; id: string; name: string; value: string; change: string;
  options: string[]; ends: [number, number]; logarithmic: boolean; disabled: boolean;
};
/** From the left and from above, in pixels of a picture. */
type Pixel = [x: number, y: number];
type Axis = { min: number; max: number; logarithmic: boolean };
/** A picture, with the plot within it in pixels: left, top, width and height. */
type Panel = {
  id: string; title: string; svg: string; size: [number, number]; plot: [number, number, number, number];
  x: Axis; y: Axis; handles: Handle[]; scrub: boolean; add: string; columns: Column[];
};
type Handle = { at: Pixel; change: string; remove: string };
/** Values here, or in the answer at the path `of`; each follows itself `times` times, and they begin again until there are `rows`. */
type Column = { name: string; of: string; values: (number | null)[]; times: number; rows: number };

/** What hears of requests: `progressed` of null at the end. */
type Page = {
  received: (answer: Answer, request: EngineRequest, milliseconds: number) => void;
  failed: (message: string) => void;
  progressed: (fraction: number | null, milliseconds: number) => void;
};
type Engine = {
  /** `progress` hears now and then of the fraction that is done. */
  compute: (request: EngineRequest, giveUp: AbortSignal, progress: (fraction: number) => void) => Promise<Answer>;
};
