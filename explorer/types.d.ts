// What the engine is asked and what it answers, as in `engine/src/request.rs` and `answer.rs`; and the shapes of plots.

/** A change of a distribution: another family; what is dragged on its curve; a node of a polygon that is added or removed; the weight of a part of a mixture, its last part in two halves, or one part less. */
type LawChange = {
  family?: string; move?: { handle: number; stretch: number; density: number }; add?: number | null; remove?: number;
  weight?: { part: number; weight: number }; split?: null; remove_part?: number;
};
/** A key of the scenario, and its new value as TOML or what changes in the distribution that is there. */
type Change = { key: string; value?: string | null; law?: LawChange };
type Part = "force" | "stretches" | "critical_stiffness" | "block" | "task";
type EngineRequest = { text: string; changes: Change[]; parts: Part[]; position: number; preview: boolean };

/** A number, or a word such as "infinite". */
type Extended = number | string;
type Place = { position: number; value: number };
type Density = { values: number[]; at: number[]; weights: number[] };
type Computed = { summary: Sliding; record: { variables: Variable[] } };
type Variable = { name: string; long_name: string; quantity: string; values: number[] };
type Sliding = {
  regime: string; reason: string; slips: number; period?: number; mean_drop?: number;
  catalogue?: { events: number; largest?: { cells: number } };
  first_instability?: { drive: number; position: number; force: number };
};
type ForceCurve = {
  position: number[]; force: number[]; force_std?: number[]; static_friction?: Place; kinetic_friction: number;
  relaxation_length: Extended; critical_stiffness: Extended; accuracy: number;
};
type StretchDistributions = {
  stretch: number[]; law_stretch: number[]; position: number;
  density: Density; steady: Density; thresholds: Density; reforming: Density; initial: Density;
};
type Answer = {
  text: string; scenario?: any; units?: Record<string, string>; failures?: string[];
  handles?: { key: string; handle: number; stretch: number; density: number; weight: number; node: boolean }[];
  invalid?: { key: string; message: string; help: string | null; line: number | null };
  force?: ForceCurve; stretches?: StretchDistributions; block?: Computed; task?: Computed;
  critical_stiffness?: { width: number[]; critical_stiffness: Extended[] };
};

type Engine = {
  /** `progress` hears now and then of the fraction that is done. */
  compute: (request: EngineRequest, giveUp: AbortSignal, progress: (fraction: number) => void) => Promise<Answer>;
};

/** Words, and the quantity whose unit they have; "number" has none. */
type Named = [words: string, quantity: string];
/** A line, or something else of which the legend has an entry. */
type Line = { label: string; color: string; dash?: number[]; as?: "dots" | "rings" | "band" };
type Handle = { x: number; y: number; move: (x: number, y: number) => void; remove?: () => void };
/** Values of cells, row by row, where each row begins, and what they are. */
type Field = { at: number[]; cells: number; values: number[]; of: Named };
type Shape = {
  /** What the horizontal and the vertical axis measure. */
  x: Named; y: Named;
  lines: Line[];
  /** Whether the horizontal and the vertical axis are logarithmic. */
  logarithmic?: [boolean, boolean];
  marks?: (pen: Pen) => void;
  /** What the legend says of marks that are there. */
  keys?: () => Line[];
  /** What the marks show, for the file of numbers. */
  more?: () => [Named, number[]][];
  handles?: () => Handle[];
  scrub?: (x: number) => void;
  /** Called where the plot is clicked twice. */
  add?: (x: number) => void;
  /** What is drawn in colours over both axes, instead of lines. */
  field?: () => Field;
};
