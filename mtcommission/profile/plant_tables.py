"""[plant] of a profile: a table for each kind of plant, built from what the kind says of its data.

The kinds describe their fields as data, so that they need no pydantic, and state each key once.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING
from functools import reduce
from operator import or_
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, GetCoreSchemaHandler, create_model, model_validator
from pydantic_core import CoreSchema

from mtcommission.machine.keys import Key, list_keys
from mtcommission.machine.mechanics import Mechanics
from mtcommission.plant.base_excited import BaseExcited
from mtcommission.plant.kinds import KINDS
from mtcommission.profile.table import Table, optional, raise_all, required
from mtcommission.profile.values import Name, Read


class DataTable(Table):
    """A table that is read into a dataclass whose fields say how they stand in a profile."""

    data_type: ClassVar[type[Any]]

    @model_validator(mode="after")
    def _check(self) -> Self:
        raise_all(self.build().find_faults())
        return self

    def build(self) -> Any:
        """Return the data, in SI."""
        return self.data_type(
            **{
                field.name: tuple(part.build() for part in getattr(self, key))
                if about.parts
                else getattr(self, key) * about.factor
                if about.allowed
                else getattr(self, key)
                for key, field, about in list_keys(self.data_type)
            }
        )


class PlantTable(DataTable):
    """[plant] of any kind."""

    def build(self) -> Mechanics:
        """Return the mechanics, in SI."""
        built: Mechanics = super().build()
        return built


def _keys(data_type: type[Any]) -> dict[str, Any]:
    """Type and field of each key, as ``create_model`` takes them."""
    return {
        key: (_type(key, about), _field(about, field.default))
        for key, field, about in list_keys(data_type)
    }


def _type(key: str, about: Key) -> Any:
    if about.parts:
        return list[_element(key, about.parts)]  # type: ignore[misc]
    if about.allowed:
        return Annotated[float, Read(about.allowed)]
    return Annotated[str, Name(is_identifier=True)]


def _field(about: Key, default: object) -> Any:
    if about.parts:
        return Field(description=about.meaning, min_length=1, max_length=about.most)
    is_bare = about.allowed is not None and not about.allowed.linear.dimension.si
    example = about.example if is_bare else f'"{about.example}"'
    if default is MISSING:
        return required(about.meaning, example)
    return optional(about.meaning, example, default)


def _element(key: str, data_type: type[Any]) -> type[DataTable]:
    """The table of an array's elements, called by the array's singular."""
    table: type[DataTable] = create_model(
        f"{key.removesuffix('s').title()}Table",
        __base__=DataTable,
        __doc__=f"[[plant.{key}]].",
        **_keys(data_type),
    )
    table.data_type = data_type
    return table


def plant_table(tag: str, data_type: type[Any]) -> type[PlantTable]:
    """Return the table of a kind of plant; the tag tells it apart within a program."""
    kind, only = data_type.kind, {"const": data_type.kind}
    form = Field(description="Form of the plant.", examples=[f'"{kind}"'], json_schema_extra=only)
    tagged: Any = Literal[tag]
    table: type[PlantTable] = create_model(
        f"{data_type.__name__}Table",
        __base__=PlantTable,
        __doc__=f'[plant] with kind = "{kind}".',
        kind=(tagged, form),
        **_keys(data_type),
    )
    table.data_type = data_type
    return table


MOTOR_HELD = "modal, motor held"
"""Tag of the modal plant below a motor that follows its setpoint: the same kind, other keys."""

PLANT_TABLES: Mapping[str, type[PlantTable]] = {
    **{tag: plant_table(tag, data_type) for tag, data_type in KINDS.items()},
    MOTOR_HELD: plant_table(MOTOR_HELD, BaseExcited),
}
"""Table of each kind of plant, by the tag that stands for its kind while it is read."""


class AnyKind:
    """Metadata of a field that holds the table of one of the kinds, told by its ``kind``."""

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Return the schema of the union."""
        union: Any = reduce(or_, PLANT_TABLES.values())
        return handler.generate_schema(Annotated[union, Field(discriminator="kind")])


def element_tables(table: type[Table]) -> dict[str, type[Table]]:
    """Return the tables of the arrays in a table of the plant, by key."""
    found = {}
    for key, field in table.model_fields.items():
        for inner in getattr(field.annotation, "__args__", ()):
            if isinstance(inner, type) and issubclass(inner, Table):
                found[key] = inner
    return found
