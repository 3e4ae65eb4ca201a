"""The explorer as a widget of notebooks: the page is a frame, and the kernel answers its requests."""

import json
import secrets
import threading
from collections.abc import Mapping
from os import PathLike
from typing import Any

from asperity._core import Result, _complete_text, _Engine, _explorer_page, run

# Passes messages on between the frame and the kernel. The page has an origin of its own, and reaches nothing
# of the notebook.
SCRIPT = """
export default {
  render({ model, el }) {
    const view = String(Math.random());
    const scenario = () => '"scenario":' + JSON.stringify(model.get("scenario")).replaceAll("<", "\\\\u003c");
    const frame = document.createElement("iframe");
    frame.sandbox = "allow-scripts allow-downloads allow-modals";
    frame.allow = "clipboard-write";
    frame.title = "asperity explorer";
    frame.style = "width: 100%; height: 900px; border: 0";
    frame.srcdoc = model.get("page").replace('"scenario":null', scenario);
    const ask = ({ source, data }) => source === frame.contentWindow && model.send({ view, ...data });
    const report = (message) => {
      if (message.view !== view) return;
      const answer = message.answer && JSON.parse(message.answer);
      frame.contentWindow?.postMessage({ number: message.number, progress: message.progress, answer }, "*");
    };
    addEventListener("message", ask);
    model.on("msg:custom", report);
    el.append(frame);
    return () => {
      removeEventListener("message", ask);
      model.off("msg:custom", report);
    };
  },
};
"""


class _NewerRequestError(Exception):
    """A newer request of the same page has come."""


class Explorer:
    """The explorer in a notebook: a page in which a scenario is changed by hand.

    The last expression of a cell shows it. It needs anywidget: ``pip install 'asperity[explorer]'``.

    Parameters
    ----------
    scenario
        As for run: the path of a file, the text of a scenario, or a dictionary.

    Raises
    ------
    TypeError
        For an argument of another type, which the message names.

    Examples
    --------
    >>> import asperity as asp
    >>> contacts = {'thresholds': asp.Gaussian(1.0, 0.1)}
    >>> explorer = asp.Explorer({'contacts': contacts, 'pull': {'distance': 5.0}})
    >>> round(explorer.result.kinetic_friction, 6)
    0.505
    """

    def __init__(self, scenario: str | PathLike[str] | Mapping[str, Any]) -> None:
        self._engine = _Engine()
        self._result: tuple[str, Result] | None = None
        self._latest: dict[str, int] = {}
        self._thread: threading.Thread | None = None
        self._widget = _widget(_complete_text(scenario))
        self._widget.on_msg(self._answer)

    @property
    def scenario(self) -> str:
        """The text of the scenario as the page shows it, once its last request is answered."""
        if self._thread is not None:
            self._thread.join()
        return str(self._widget.scenario)

    @property
    def result(self) -> Result:
        """The result of run for this scenario, computed once it is asked for."""
        text = self.scenario
        if self._result is None or self._result[0] != text:
            self._result = text, run(text)
        return self._result[1]

    def _answer(self, _: Any, message: dict[str, Any], __: Any) -> None:
        """Answers a request of the page on a thread of its own, so that the kernel hears of a newer one."""
        self._latest[message["view"]] = message["number"]
        self._thread = threading.Thread(target=self._compute, args=(message,), daemon=True)
        self._thread.start()

    def _compute(self, message: dict[str, Any]) -> None:
        """Answers a request, unless it is given up for a newer one."""
        asked = {"view": message["view"], "number": message["number"]}

        def check() -> None:
            if self._latest[asked["view"]] != asked["number"]:
                raise _NewerRequestError

        def report(fraction: float) -> None:
            check()
            self._widget.send({**asked, "progress": fraction})

        try:
            answer = self._engine.answer(json.dumps(message["request"]), report)
            # The scenario is that of the last request, whichever ends last.
            check()
        except _NewerRequestError:
            return
        self._widget.send({**asked, "answer": answer})
        # An answer to a request that is not valid has no text.
        if text := json.loads(answer)["text"]:
            self._widget.scenario = text

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        return self._widget._repr_mimebundle_(**kwargs)


def _widget(scenario: str) -> Any:
    """The widget with the page."""
    try:
        from anywidget import AnyWidget
        from traitlets import Unicode
    except ImportError as error:
        raise ImportError("Explorer needs anywidget: pip install 'asperity[explorer]'") from error
    traits = {"page": Unicode().tag(sync=True), "scenario": Unicode().tag(sync=True)}
    kind = type("ExplorerWidget", (AnyWidget,), {"_esm": SCRIPT, **traits})
    return kind(page=_explorer_page(secrets.token_hex(16)), scenario=scenario)
