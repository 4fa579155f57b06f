"""Parameters of the MCP tools, with descriptions and valid values."""

from collections.abc import Callable, Sequence
from typing import Annotated, Literal

from pydantic import AfterValidator, Field, WithJsonSchema

from kinesic.body.config import names_of
from kinesic.mcp.document_schema import BML_SCHEMA

MAX_TEXT_LENGTH = 200_000  # [characters] longest text of a call, about 35 000 words
MAX_DOCUMENT_LENGTH = 900_000  # [characters] longest document of a call
MAX_QUERY_LENGTH = 200  # [characters] longest query of a gesture search
MAX_NAME_LENGTH = 64  # [characters] longest block id in a call
DEFAULT_WAIT = 30.0  # [s] default time limit of a call to `wait`
MAX_WAIT = 50.0  # [s] largest time limit of a call to `wait`; many clients give up after 60 s
MAX_RESULTS = 25  # largest number of gestures in an answer
DEFAULT_RESULTS = 8  # default number of gestures in an answer

STYLE_NAMES = names_of("style")  # names of the built-in styles
DOCUMENT_TEXT = "One performance as a JSON object (preferred), or BML 1.0 as XML text."
PREVIEW_TEXT = (
    "One performance, exactly as perform takes it: a JSON object with id and behaviours (schema: kinesic://schema), or "
    "BML 1.0 as XML text."
)


def check_choice(names: Sequence[str]) -> Callable[[str], str]:
    """Return a validator that accepts these names and the empty text."""

    def check(name: str) -> str:
        if name and name not in names:
            raise ValueError(", ".join(names))
        return name

    return check


def choice_schema(names: Sequence[str], description: str) -> WithJsonSchema:
    """Return the JSON schema of a text parameter with listed values."""
    return WithJsonSchema({"type": "string", "enum": list(names), "description": description})


Text = Annotated[
    str,
    Field(
        max_length=MAX_TEXT_LENGTH,
        description="What to say, in plain sentences. *word* stresses a word, (laughs) is performed.",
    ),
]
Query = Annotated[
    str,
    Field(
        max_length=MAX_QUERY_LENGTH,
        description="Meaning of the gesture in a few English words, such as 'weigh two things' or 'very big'.",
    ),
]
Count = Annotated[int, Field(ge=1, le=MAX_RESULTS, description="Largest number of gestures in the answer.")]
Style = Annotated[
    str,
    AfterValidator(check_choice(STYLE_NAMES)),
    choice_schema(STYLE_NAMES, "How everything moves. Leave it out for the robot's usual style."),
]
_Document = Annotated[str, Field(max_length=MAX_DOCUMENT_LENGTH)] | dict[str, object]
Document = Annotated[
    _Document, WithJsonSchema({"anyOf": [dict(BML_SCHEMA), {"type": "string"}], "description": DOCUMENT_TEXT})
]
PreviewedDocument = Annotated[_Document, WithJsonSchema({"type": ["object", "string"], "description": PREVIEW_TEXT})]
Direction = Annotated[
    Literal["AUDIENCE", "LEFT", "RIGHT", "UP", "DOWN", "UPLEFT", "UPRIGHT", "DOWNLEFT", "DOWNRIGHT"],
    Field(description="Where to look, seen from the robot. AUDIENCE is straight ahead."),
]
BlockName = Annotated[
    str,
    Field(
        max_length=MAX_NAME_LENGTH,
        description="Value of `block` in the answer of perform, say or look. Leave it out to wait until nothing plays.",
    ),
]
Seconds = Annotated[
    float,
    Field(ge=0.0, le=MAX_WAIT, description="Longest time to wait [s], unless the performance ends earlier."),
]
Conversing = Annotated[bool, Field(description="true begins the conversation or changes its options, false ends it.")]
Amount = Annotated[float, Field(ge=0.0, le=1.0, description="Amount of movement while the robot attends to people.")]
Fillers = Annotated[bool, Field(description="Whether the robot says a short 'Hm.' while an answer takes long.")]
Thinking = Annotated[bool, Field(description="true while an answer is being prepared, false when it is ready.")]
