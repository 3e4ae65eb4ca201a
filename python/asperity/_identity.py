"""What identifies a function of the user in a folder: its name, its code and the values that it reads."""

import copyreg
import dis
import hashlib
from collections.abc import Callable, Iterable, Iterator, Mapping
from types import BuiltinFunctionType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

from asperity._arguments import wrong
from asperity._core import Description, __version__

# Values whose text is all that they are. An int may be too long for its decimal text.
PLAIN = (type(None), bool, float, complex, str)
# Instructions that write global names.
WRITES = ("STORE_GLOBAL", "DELETE_GLOBAL")
# Functions of global names count by their names.
FUNCTIONS: tuple[type, ...] = (FunctionType, BuiltinFunctionType)
CALL = "__call__"
# The protocol of pickles that describes objects. It is fixed, so that new versions of Python change nothing.
PROTOCOL = 4


def identity(function: Callable[..., Any], axes: Mapping[str, list[Any]]) -> str:
    """What identifies a sweep of a function: its name, its code and values, and the version."""
    name = name_of(function if hasattr(function, "__qualname__") else type(function))
    parts = [__version__, name, Values("scenario").of(function)]
    parts += [f"{key}={Values(f'over.{key}').of(values)}" for key, values in axes.items()]
    return "\n".join(parts)


def name_of(value: Any) -> str:
    """The name of a function or of a class, with its module."""
    return f"{getattr(value, '__module__', '')}.{value.__qualname__}"


def combined(kind: str, parts: Iterable[str]) -> str:
    """The hash of the descriptions of the parts of a value. None of them has more than one line."""
    return hashlib.sha256("\n".join([kind, *parts]).encode(errors="surrogatepass")).hexdigest()


class Values:
    """Describes values without their places in memory, so that equal ones are the same in another process."""

    def __init__(self, name: str) -> None:
        self.name = name
        # Values that were met, which refer to each other in circles, by their places in memory. They are
        # kept, because the place of a value that is gone is used again.
        self.met: dict[int, tuple[int, object]] = {}

    def of(self, value: Any) -> str:
        """A text of one line for a value; a TypeError for one that has no description."""
        kind = type(value)
        if kind in PLAIN:
            return f"{kind.__name__} {value!r}"
        if kind is int:
            return hex(value)
        if kind is bytes:
            return f"bytes {hashlib.sha256(value).hexdigest()}"
        if isinstance(value, np.generic) and not value.dtype.hasobject:
            return f"{value.dtype.str} {value.tobytes().hex()}"
        if isinstance(value, ModuleType):
            return f"module {value.__name__}"
        if isinstance(value, type):
            return f"class {name_of(value)}"
        if kind is tuple:
            return combined("tuple", map(self.of, value))
        if kind in (set, frozenset):
            # The order of a set is another one in each process.
            return combined(kind.__name__, sorted(Values(self.name).of(one) for one in value))
        if id(value) in self.met:
            return f"again {self.met[id(value)][0]}"
        self.met[id(value)] = len(self.met), value
        return combined(kind.__name__, self._parts(value))

    def _parts(self, value: Any) -> Iterator[str]:
        """The descriptions of what a value consists of."""
        if type(value) is list:
            return map(self.of, value)
        if type(value) is dict:
            return (self.of(part) for item in value.items() for part in item)
        if isinstance(value, CodeType):
            return self._code(value)
        if isinstance(value, FunctionType):
            return self._function(value)
        if isinstance(value, MethodType):
            return self._method(value)
        return self._object(value)

    def _code(self, code: CodeType) -> Iterator[str]:
        """A code without its place in files."""
        yield self.of(code.co_code)
        # Which instructions are within a try.
        yield self.of(code.co_exceptiontable)
        # Instructions refer to names by numbers.
        yield self.of((code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars))
        yield self.of((code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags))
        yield self.of(code.co_consts)

    def _function(self, function: FunctionType) -> Iterator[str]:
        yield name_of(function)
        yield self.of(function.__code__)
        yield self.of((function.__defaults__, function.__kwdefaults__))
        for cell in function.__closure__ or ():
            yield self._cell(cell)
        if "__wrapped__" in vars(function):
            yield self.of(vars(function)["__wrapped__"])
        for name, value in globals_of(function):
            yield f"{name}={name_of(value) if isinstance(value, FUNCTIONS) else self.of(value)}"

    def _cell(self, cell: Any) -> str:
        try:
            value = cell.cell_contents
        except ValueError:
            return "empty"
        return self.of(value)

    def _if_any(self, value: Any) -> str:
        """Locks, files and the like are no values that a result depends on, where they are not enclosed."""
        try:
            return self.of(value)
        except Exception:
            return f"a {type(value).__name__}"

    def _method(self, method: MethodType) -> Iterator[str]:
        owner = method.__self__
        yield self.of(method.__func__)
        yield self.of(owner)
        yield from self._shared(owner if isinstance(owner, type) else type(owner))

    def _shared(self, kind: type) -> Iterator[str]:
        """The values of a class, which its objects share."""
        for base in kind.__mro__:
            for name, value in vars(base).items():
                own = not name.startswith("__") and not callable(value) and not hasattr(value, "__get__")
                if own:
                    yield f"{name}={self._if_any(value)}"

    def _object(self, value: Any) -> Iterator[str]:
        """An object as its pickle describes it, and the code by which it is called."""
        yield f"class {name_of(type(value))}"
        wrapped = getattr(value, "__dict__", {}).get("__wrapped__")
        own = any("__reduce__" in vars(base) for base in type(value).__mro__[:-1])
        if wrapped is not None and own:
            # A cache, or a compiled function: its pickle is a name, or has what it has found so far.
            yield self.of(wrapped)
            return
        found = self._reduced(value)
        if isinstance(found, str):
            yield f"{getattr(value, '__module__', '')}.{found}"
            return
        make, arguments, state, items, pairs = (*found, None, None, None)[:5]
        yield name_of(make) if hasattr(make, "__qualname__") else self.of(make)
        yield self.of((arguments, state))
        yield self.of((list(items or ()), list(pairs or ())))
        call = getattr(type(value), CALL, None)
        if isinstance(call, FunctionType):
            yield self.of(call)
            yield from self._shared(type(value))

    def _reduced(self, value: Any) -> Any:
        try:
            reduce = copyreg.dispatch_table.get(type(value))
            return value.__reduce_ex__(PROTOCOL) if reduce is None else reduce(value)
        except Exception:
            expected = "values that can be pickled, by which a folder identifies the sweep of a function"
            raise wrong(self.name, expected, value) from None


def globals_of(function: FunctionType) -> Iterator[tuple[str, Any]]:
    """The functions and the values without parts that change which a function finds by global names.

    Not those that it writes, such as counters.
    """
    named, written = names_of(function.__code__)
    for name in sorted(named - written):
        value = function.__globals__.get(name, ...)
        if isinstance(value, FUNCTIONS) or is_constant(value):
            yield name, value


def is_constant(value: Any) -> bool:
    """Whether a value is a number, a text, an array, a description, or a tuple of such values."""
    if type(value) is tuple:
        return all(map(is_constant, value))
    if isinstance(value, np.ndarray | np.generic):
        return not value.dtype.hasobject
    return isinstance(value, Description) or type(value) in (*PLAIN, int, bytes)


def names_of(code: CodeType) -> tuple[set[str], set[str]]:
    """The names by which a code and those within it find values, and the global ones that they write."""
    named = set(code.co_names)
    written = {step.argval for step in dis.get_instructions(code) if step.opname in WRITES}
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            found = names_of(inner)
            named, written = named | found[0], written | found[1]
    return named, written
