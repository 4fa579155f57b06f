"""Three stories of about a minute, for measurements of rhythm."""

from collections.abc import Mapping

STORIES: Mapping[str, str] = {
    "market": (
        "Last Saturday I went down to the market to buy some apples for my grandmother. It was early, and the whole "
        "square was still empty, apart from one old man who was building a tower of boxes. He carried them across the "
        "road, one after another, and put each box on top of the last one. I stopped and watched, because the tower "
        "leaned a little further to the left with every box. Then a small dog came round the corner. It ran straight "
        "between his legs, and the man turned, and slipped, and held on to the tower. For a moment nothing moved. Then "
        "everything came down at once, and forty boxes of oranges rolled across the square. The dog was delighted. It "
        "chased one orange under a car and another into the fountain. I did not know what to do, so I began to pick "
        "them up. Soon the baker helped, and the postman, and two children on their way to school. When the last "
        "orange was back in its box, the old man gave each of us one. He said that it was the best morning he had had "
        "for years."
    ),
    "lecture": (
        "Good evening, and thank you for coming. Tonight I want to talk about sleep, and about the reasons why we need "
        "so much of it. For a long time people believed that the brain simply switches off at night. We know today "
        "that this is not true. During the night the brain sorts the memories of the day: it keeps what matters, and "
        "throws the rest away. There are three things that everybody should know. First, regular hours help more than "
        "long hours. Second, bright light in the evening moves the inner clock by as much as two hours. And third, "
        "nobody gets used to short nights; we only stop noticing how tired we are. In a famous experiment, students "
        "slept for four hours a night. After two weeks they reacted as slowly as people who had not slept for two "
        "days. And yet they were convinced that they were doing well. So what can you do? Put the telephone in another "
        "room, open the window, and go to bed at the same time every night. It sounds simple, but very few of us do it."
    ),
    "journey": (
        "When my brother was twelve, he decided to build a boat. He found some planks behind the barn, and a huge "
        "sheet of plastic, and he worked in the garden for the whole summer. My father thought that it would never "
        "float. My mother said that it was beautiful, but that he must not go out on the river alone. So one morning "
        "in August we all stood on the bank: the neighbours, the dog, and a reporter from the local newspaper. My "
        "brother climbed in and pushed off. At first the boat turned round and round, like a leaf. He pulled on the "
        "left oar, and it turned right; he pulled on the right oar, and nothing happened at all. We shouted, but he "
        "could not hear us. Then the current caught him, and he went faster and faster towards the bridge. Everybody "
        "ran. Under the bridge the boat stopped, with a long and terrible noise, and slowly broke in two. My brother "
        "stepped out into the water. It came up to his knees. He looked at us and laughed, and said that the next one "
        "would be bigger."
    ),
}  # title -> text
